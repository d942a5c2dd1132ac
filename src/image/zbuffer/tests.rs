//! Round trips, and the conditions 100 to 106 of Vol.

#![expect(clippy::float_cmp, reason = "depths are kept bit for bit")]

use std::fs;

use glam::DVec3;

use super::*;
use crate::image::{Encoding, Image};

fn depths() -> ZBuffer {
    let matrix = |first: u8| std::array::from_fn(|i| std::array::from_fn(|k| f32::from(first + 4 * i as u8 + k as u8)));
    ZBuffer {
        width: 3,
        height: 2,
        screen_from_world: matrix(1),
        view_from_world: matrix(101),
        depth_world: vec![1.5, 0.25, f32::INFINITY, -2.0, 3e9, f32::MIN_POSITIVE],
    }
}

fn bytes(order: ByteOrder) -> Vec<u8> {
    let mut bytes = Vec::new();
    depths().write(&mut bytes, order).unwrap();
    bytes
}

/// The condition of an error, and that its number is in its message.
#[track_caller]
fn refused<T: std::fmt::Debug>(result: Result<T>, expected: VolCondition) {
    let error = result.unwrap_err();
    let message = error.to_string();
    assert!(message.contains(&format!("(Vol's error {})", expected.number())), "{message}");
    let inner = if let Error::InFile { source, .. } = error { *source } else { error };
    assert!(matches!(inner, Error::Vol { condition, .. } if condition == expected), "{inner:?}");
}

#[test]
fn a_file_comes_back_in_either_byte_order() {
    let folder = tempfile::tempdir().unwrap();
    for (order, first) in [(ByteOrder::Little, 0xab), (ByteOrder::Big, 0x2f)] {
        let path = folder.path().join(format!("{order:?}.vol"));
        depths().save(&path, order).unwrap();
        let written = fs::read(&path).unwrap();
        assert_eq!((written[0], written.len()), (first, 4 + 4 + 128 + 24));
        assert_eq!(ZBuffer::open(&path).unwrap(), depths());
        assert_eq!(ZBuffer::recognise(&written), Some(order));
    }
    // Nothing has no word of its own in the format.
    assert_eq!(bytes(ByteOrder::Big)[136 + 8..][..4], 1e30_f32.to_be_bytes());
}

#[test]
fn error_100_a_file_that_cannot_be_read() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the disk is gone"))
        }
    }
    refused(ZBuffer::read(Broken), VolCondition::Read);
    refused(ZBuffer::read((&bytes(ByteOrder::Big)[..150]).chain(Broken)), VolCondition::Read);
    let mut nan = bytes(ByteOrder::Little);
    nan[136..140].copy_from_slice(&f32::NAN.to_le_bytes());
    refused(ZBuffer::read(&nan[..]), VolCondition::Read);
    #[cfg(unix)]
    refused(ZBuffer::open(std::env::temp_dir()), VolCondition::Read);
}

#[test]
fn error_101_another_magic_number() {
    refused(ZBuffer::read(&b"\x2f\x08\x67\xac and more"[..]), VolCondition::Magic);
    refused(ZBuffer::read(&b"PNG"[..]), VolCondition::Magic);
    let mut swapped = bytes(ByteOrder::Big);
    swapped.swap(0, 1);
    refused(ZBuffer::read(&swapped[..]), VolCondition::Magic);
}

#[test]
fn error_102_a_size_that_does_not_fit() {
    for (at, side) in [(4, 0_i16), (6, 0), (4, -3), (6, i16::MIN)] {
        let mut wrong = bytes(ByteOrder::Little);
        wrong[at..at + 2].copy_from_slice(&side.to_le_bytes());
        refused(ZBuffer::read(&wrong[..]), VolCondition::Size);
    }
    let folder = tempfile::tempdir().unwrap();
    let (path, colors) = (folder.path().join("a.vol"), folder.path().join("a.png"));
    depths().save(&path, ByteOrder::Big).unwrap();
    Image::filled(2, 3, [0.5; 4]).save(&colors, &Encoding::default()).unwrap();
    refused(DepthImage::open(&path, Some(&colors)), VolCondition::Size);
    let picture = DepthImage::open(&path, None).unwrap();
    let whole = |width, height| picture.part([width, height], crate::Region::whole([width, height]));
    assert!(whole(3, 2).is_ok());
    refused(whole(2, 3), VolCondition::Size);
    refused(ZBuffer::check_size([32_768, 4]), VolCondition::Size);
    refused(DepthImage::new(Image::filled(2, 2, [1.0; 4]), vec![1.0; 3]), VolCondition::Size);
}

#[test]
fn errors_103_and_106_more_memory_than_there_is() {
    for condition in [VolCondition::Memory, VolCondition::ImageMemory] {
        refused(allocate(condition, || "a picture of all of it".to_owned(), u64::MAX), condition);
        assert!(allocate(condition, || "a picture of nothing".to_owned(), 0).is_ok());
    }
}

#[test]
fn error_104_a_file_that_ends_early() {
    for order in [ByteOrder::Little, ByteOrder::Big] {
        let whole = bytes(order);
        for len in 0..whole.len() {
            refused(ZBuffer::read(&whole[..len]), VolCondition::EndOfFile);
        }
    }
}

#[test]
fn error_105_a_file_that_is_not_there() {
    refused(ZBuffer::open("no such folder/a.vol"), VolCondition::Open);
    refused(DepthImage::open("no such folder/a.exr", None), VolCondition::Open);
}

#[test]
fn colour_and_depth_come_back_from_an_exr() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let image = Image {
        width: 2,
        height: 2,
        pixels: vec![[0.5, 0.25, 0.125, 0.5], [1e-9, 2.0, 0.0, 1.0], [0.0; 4], [0.1, 0.2, 0.3, 1.0]],
    };
    let picture = DepthImage::new(image.clone(), vec![1.0, 1e-3, 4.0, f32::INFINITY]).unwrap();
    // What is transparent has no depth.
    assert_eq!(picture.depth_world, [1.0, 1e-3, f32::INFINITY, f32::INFINITY]);
    picture.save(&path, None).unwrap();
    assert_eq!(DepthImage::open(&path, None).unwrap(), picture);
    // Colours of another file, sRGB in a PNG.
    let colors = folder.path().join("a.png");
    Image::filled(2, 2, [0.5, 0.5, 0.5, 1.0]).save(&colors, &Encoding::default()).unwrap();
    let other = DepthImage::open(&path, Some(&colors)).unwrap();
    assert!((other.image.pixel(0, 0)[1] - 0.5).abs() < 5e-3 && other.depth_world[1] == 1e-3);
    // Without depth there is nothing to composite by; others read it as a picture.
    image.save(&path, &Encoding::default()).unwrap();
    let refused = DepthImage::open(&path, None).unwrap_err().to_string();
    assert!(refused.contains("without a depth channel Z"), "{refused}");
    assert!(DepthImage::check_output(folder.path().join("a.png"), [2, 2]).is_err());
}

#[test]
fn a_z_buffer_holds_the_matrices_of_its_camera() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vol");
    let mut camera = Camera::looking_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, 2, 1);
    let picture = DepthImage::new(Image::filled(2, 1, [0.0, 0.0, 0.0, 1.0]), vec![4.0, 8.0]).unwrap();
    picture.save(&path, Some(&camera)).unwrap();
    let read = ZBuffer::open(&path).unwrap();
    assert_eq!([read.screen_from_world, read.view_from_world], camera.matrices([4.0, 8.0]).unwrap());
    camera.far = Some(100.0);
    picture.save(&path, Some(&camera)).unwrap();
    assert_eq!(ZBuffer::open(&path).unwrap().screen_from_world, camera.matrices([4.0, 100.0]).unwrap()[0]);
}
