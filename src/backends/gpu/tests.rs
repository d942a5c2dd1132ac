//! The shaders against Rust: every offset they read, and every integral they compute.

use std::mem::offset_of;

use naga::{Module, TypeInner};
use wgpu::BufferUsages as Usage;

use super::layout::{BandPieceRecord, FrameUniform, GeometryUniform, PieceRecord};
use super::{Gpu, adapters, shaders};
use crate::optics::integral::{
    segment_weights, segment_weights_average, segment_weights_thin, segment_weights_very_thin,
};
use crate::optics::{Integral, Model, Output, Shading, wgsl};
use crate::stages::fans::{CaseFan, Contents, Faces, Fan, HexFan, PlaneFan, PolyFan};

const ONLY_FANS: Contents = Contents { has_planes: false, whole_cells: None, has_polyhedra: false };
const RECORDS: Contents = Contents { has_planes: true, whole_cells: Some(Faces::Exact), has_polyhedra: true };

fn all_shadings() -> Vec<Shading> {
    let models = Model::ALL.into_iter().flat_map(|model| Integral::ALL.map(|integral| (model, integral)));
    let plain = models.map(|(model, integral)| Shading { model, integral, ..Shading::default() });
    let absorption = Shading { model: Model::Absorption, ..Shading::default() };
    let in_bands = [
        Shading { has_bands: true, ..Shading::default() },
        Shading { has_bands: true, ..absorption },
        Shading { output: Output::Depth, ..absorption },
        Shading { has_bands: true, output: Output::Depth, ..absorption },
    ];
    plain.chain(in_bands).collect()
}

/// Name and offset of each member of a struct, and its span.
fn members(module: &Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
    let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
    let member = |member: &naga::StructMember| (member.name.clone().unwrap(), member.offset as usize);
    (members.iter().map(member).collect(), *span as usize)
}

macro_rules! offsets {
    ($type:ty: $($member:ident),*) => {
        (vec![$((stringify!($member).to_owned(), offset_of!($type, $member))),*], size_of::<$type>())
    };
}

#[test]
fn shaders_parse_and_read_what_rust_writes() {
    for shading in all_shadings() {
        let text = shaders::of(shading).draw_text(RECORDS, false);
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let frame = offsets!(
            FrameUniform: ndc_scale, ndc_offset, ray, is_perspective, ray_step_x, piece_count, ray_step_y, v_far,
            v_near, texels, texels_per_length, texels_per_extinction, s_middle, s_scale,
            order_scale, order_offset, first_px, tile_columns, first_tile
        );
        assert_eq!(members(&module, "Frame"), frame, "{shading:?}");
        let piece = offsets!(
            PieceRecord: begin, end, start, extinction, color, extinction_slope, color_slope, is_transparent
        );
        let band_piece = offsets!(
            BandPieceRecord: begin, end, start, is_transparent, extinction, extinction_slope, color, color_slope
        );
        assert_eq!(members(&module, "Piece"), if shading.has_bands { band_piece } else { piece });
        // Fans are read as words: these are the places that `shaders/fans.wgsl` names.
        assert_eq!(members(&module, "Fan"), (vec![("words".to_owned(), 0)], size_of::<Fan>()));
    }
    let text = shaders::geometry_text();
    let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    let geometry = offsets!(
        GeometryUniform: eye, is_perspective, forward, near, to_x, center_x, to_y, center_y, first, v_far, step_x, v_near,
        step_y, setback_px, color, width_px, ndc_scale, ndc_offset, size_px, z_scale, z_offset, first_px,
        has_back_only, has_looks
    );
    assert_eq!(members(&module, "Geometry"), geometry);
    let words = |bytes: usize| (bytes / 16, bytes % 16 / 4);
    assert_eq!([offset_of!(Fan, thick_px), offset_of!(Fan, s_range)].map(words), [(0, 0), (0, 2)]);
    assert_eq!(
        [offset_of!(Fan, front), offset_of!(Fan, back), offset_of!(Fan, ring)].map(words),
        [(1, 0), (1, 2), (2, 0)]
    );
    assert_eq!([offset_of!(PlaneFan, box_px), offset_of!(PlaneFan, s_range)].map(words), [(0, 0), (0, 2)]);
    let rest = [
        offset_of!(PlaneFan, v_range),
        offset_of!(PlaneFan, constant),
        offset_of!(PlaneFan, fronts),
        offset_of!(PlaneFan, planes),
    ];
    assert_eq!(rest.map(words), [(1, 0), (1, 2), (1, 3), (2, 0)]);
    let hexahedron = [
        offset_of!(HexFan, box_px),
        offset_of!(HexFan, s_range),
        offset_of!(HexFan, v_origin),
        offset_of!(HexFan, flags),
        offset_of!(HexFan, corners),
    ];
    assert_eq!(hexahedron.map(words), [(0, 0), (0, 2), (1, 0), (1, 3), (2, 0)]);
    let polyhedron = [
        offset_of!(PolyFan, box_px),
        offset_of!(PolyFan, s_range),
        offset_of!(PolyFan, list),
        offset_of!(PolyFan, corners),
        offset_of!(PolyFan, around),
        offset_of!(PolyFan, flags),
        offset_of!(PolyFan, w_middle),
        offset_of!(PolyFan, w_least),
    ];
    assert_eq!(polyhedron.map(words), [(0, 0), (0, 2), (1, 0), (1, 1), (1, 2), (1, 3), (2, 0), (2, 1)]);
    assert_eq!(PolyFan::IS_CONSTANT, HexFan::IS_CONSTANT);
    let text = shaders::of(Shading::default()).draw_text(RECORDS, false);
    for (name, value) in [
        ("DIAGONALS", HexFan::DIAGONALS),
        ("IS_HOMOGENEOUS", HexFan::IS_HOMOGENEOUS),
        ("IS_CONSTANT", HexFan::IS_CONSTANT),
        ("IS_HEXAHEDRON", HexFan::HEXAHEDRON),
        ("IS_POLYHEDRON", PolyFan::POLYHEDRON),
        ("FIRST_OF_FACE", PolyFan::FIRST.into()),
        ("CASE_FANS", CaseFan::FANS as u32),
        ("CASE_TRIANGLES", CaseFan::TRIANGLES_MAX as u32),
        ("CASE_VERTICES", (offset_of!(CaseFan, vertices) / 4) as u32),
        ("CASE_INDICES", (offset_of!(CaseFan, triangles) / 4) as u32),
        ("CASE_MARK", (offset_of!(CaseFan, mark) / 4) as u32),
    ] {
        let is_it = |line: &str| {
            [format!("{value}u"), format!("{value:#x}u")].iter().any(|v| line.ends_with(&format!(" = {v};")))
        };
        let line = text.lines().find(|line| line.starts_with(&format!("const {name}:"))).unwrap();
        assert!(is_it(line), "{line}, not {value}");
    }
}

#[test]
fn all_shaders_are_valid() {
    let texts = all_shadings().into_iter().flat_map(|shading| {
        [(ONLY_FANS, false), (RECORDS, false), (ONLY_FANS, true), (RECORDS, true)]
            .map(|(contents, is_ended)| shaders::of(shading).draw_text(contents, is_ended))
    });
    let others = [shaders::resolve_text(false), shaders::resolve_text(true), shaders::geometry_text()];
    for text in texts.chain(others) {
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let mut validator =
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
        validator.validate(&module).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    }
}

type Weights = fn(f32, f32) -> crate::optics::SegmentWeights;

/// Runs `fn pair(x, y) -> vec4` of the integrals' shader on pairs of optical depths.
fn on_gpu(gpu: &Gpu, pairs: &[[f32; 2]], of: &str) -> Vec<[f32; 4]> {
    let text = format!(
        "{}\n{}\n{of}\n
        @group(0) @binding(0) var<storage, read> pairs: array<vec2<f32>>;
        @group(0) @binding(1) var<storage, read_write> results: array<vec4<f32>>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
            if id.x < arrayLength(&pairs) {{ results[id.x] = pair(pairs[id.x].x, pairs[id.x].y); }}
        }}",
        wgsl::constants(),
        include_str!("../../../shaders/integral.wgsl")
    );
    let device = &gpu.device;
    let module = shaders::module(device, "integrals", text);
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let buffer = |size: usize, usage| {
        let size = size as u64;
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let input = buffer(size_of_val(pairs), Usage::STORAGE | Usage::COPY_DST);
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(pairs));
    let output = buffer(2 * size_of_val(pairs), Usage::STORAGE | Usage::COPY_SRC);
    let read = buffer(2 * size_of_val(pairs), Usage::MAP_READ | Usage::COPY_DST);
    let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[(0, &input), (1, &output)]
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }),
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bindings, &[]);
    pass.dispatch_workgroups(pairs.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&output, 0, &read, 0, output.size());
    gpu.queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    gpu.check().unwrap();
    let bytes = read.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

#[test]
fn integrals_are_those_of_the_processor() {
    let depths: Vec<f32> = (0..140).map(|i| 1e-6 * 1.2_f32.powi(i)).chain([0.0, 2.0, 0.0625]).collect();
    let pairs: Vec<[f32; 2]> = depths.iter().flat_map(|&x| depths.iter().map(move |&y| [x, y])).collect();
    let exact: Weights = |x, y| match 0.5 * x + 0.5 * y {
        m if m <= crate::optics::integral::VERY_THIN_LIMIT => segment_weights_very_thin(x, y),
        m if m <= crate::optics::attenuation::THIN_LIMIT => segment_weights_thin(x, y),
        _ => segment_weights(x, y),
    };
    for adapter in adapters() {
        let gpu = Gpu::open(Some(&adapter.name)).unwrap();
        for (name, expected) in [("segment_weights", exact), ("segment_weights_average", segment_weights_average)] {
            let of = format!(
                "fn pair(x: f32, y: f32) -> vec4<f32> {{ let w = {name}(x, y); return vec4<f32>(w.w0, w.w1, w.transmittance, 0.0); }}"
            );
            let mut worst = [0.0_f32; 3];
            for (&[x, y], found) in pairs.iter().zip(on_gpu(&gpu, &pairs, &of)) {
                let w = expected(x, y);
                for (worst, (found, expected)) in
                    worst.iter_mut().zip(found.into_iter().zip([w.w0, w.w1, w.transmittance]))
                {
                    let off = (found - expected).abs();
                    assert!(off < 2e-6, "{name}({x}, {y}): {found}, not {expected}");
                    *worst = worst.max(off);
                }
            }
            println!("{name} on {adapter}: largest differences {worst:?}");
        }
        // The comparison fails where an integral is another.
        let of = "fn pair(x: f32, y: f32) -> vec4<f32> { return vec4<f32>(segment_weights_average(x, y).w0); }";
        let others = on_gpu(&gpu, &pairs, of);
        assert!(pairs.iter().zip(others).any(|(&[x, y], found)| (found[0] - exact(x, y).w0).abs() > 1e-3));
    }
}
