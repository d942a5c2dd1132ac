//! From good files to bad ones: changes of bytes, and of what text formats are made of.
//!
//! A change finds its place by looking on from a random byte for the next number, attribute, tag or line; where there is
//! none, it changes nothing. One to five changes follow each other.

use std::ops::Range;

use crate::random::Random;
use crate::seeds::Seeds;

/// No input grows beyond this.
const LONGEST: usize = 1 << 20;

/// Numbers in text that readers trip over.
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "1",
    "2",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967294",
    "4294967295",
    "4294967296",
    "4611686018427387904",
    "6148914691236517206",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "-9223372036854775808",
    "0.5",
    "-0",
    "+7",
    "1e3",
    "1e38",
    "4e38",
    "1e308",
    "-1e308",
    "1e400",
    "1e-400",
    "1e-45",
    "5e-324",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "1.#QNAN",
    "1.0D+03",
    "0x10",
    "1_000",
    "",
    "999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999",
    "0.000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000001",
];

/// Words in binary files that readers trip over.
const WORDS: &[u64] = &[
    0,
    1,
    2,
    7,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x1_0000,
    0x10_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_fffe,
    0xffff_ffff,
    0x1_0000_0000,
    1 << 40,
    1 << 61,
    1 << 62,
    i64::MAX as u64,
    1 << 63,
    u64::MAX - 1,
    u64::MAX,
    0x7ff0_0000_0000_0000, // infinity
    0x7ff8_0000_0000_0000, // NaN
    0x7f80_0000,
    0x7fc0_0000,
];

/// What mutations are made from.
pub(crate) struct Mutator<'a> {
    pub(crate) seeds: &'a Seeds,
    pub(crate) words: &'a [&'a str],
}

impl Mutator<'_> {
    /// The next bad file.
    pub(crate) fn mutate(&self, random: &mut Random) -> Vec<u8> {
        let mut file = random.choose(self.seeds).clone();
        for _ in 0..=random.below(5) {
            self.change(&mut file, random);
            file.truncate(LONGEST);
        }
        file
    }

    fn change(&self, file: &mut Vec<u8>, random: &mut Random) {
        let at = random.below(file.len());
        match random.below(24) {
            0 => {
                if let Some(byte) = file.get_mut(at) {
                    *byte ^= 1 << random.below(8);
                }
            }
            1 => {
                if let Some(byte) = file.get_mut(at) {
                    *byte = random.bits() as u8;
                }
            }
            2 => replace(file, at..at, &[*random.choose(b"<>&\"'=/[]{},:;#%-+.eE0 \n\0\xff!")]),
            3 => file.truncate(at),
            4 => {
                let end = (at + 1 + random.below(64)).min(file.len());
                replace(file, at..end, b"");
            }
            5 => {
                // The same again, here or elsewhere.
                let end = (at + 1 + random.below(256)).min(file.len());
                let part = file.get(at..end).unwrap_or_default().to_vec();
                let to = random.below(file.len() + 1);
                replace(file, to..to, &part);
            }
            6 => self.splice(file, at, random),
            7 | 8 => word(file, at, random),
            9..=12 => {
                if let Some(range) = number_after(file, at) {
                    replace(file, range, random.choose(NUMBERS).as_bytes());
                }
            }
            13 => {
                // Two numbers change places.
                let (first, second) = (number_after(file, at), number_after(file, random.below(file.len())));
                swap(file, first, second);
            }
            14 | 15 => attribute(file, at, random),
            16 => {
                let (first, second) = (tag_after(file, at), tag_after(file, random.below(file.len())));
                swap(file, first, second);
            }
            17 => {
                if let Some(range) = tag_after(file, at) {
                    let tag = file[range.clone()].to_vec();
                    let times = *random.choose(&[0, 2, 3, 40, 400]);
                    replace(file, range, &tag.repeat(times));
                }
            }
            18 => {
                let (first, second) = (line_after(file, at), line_after(file, random.below(file.len())));
                swap(file, first, second);
            }
            19 => {
                if let Some(range) = line_after(file, at) {
                    let line = file[range.clone()].to_vec();
                    replace(file, range, &line.repeat(*random.choose(&[0, 2, 50])));
                }
            }
            20 => {
                let open = *random.choose(&["[", "{\"a\":", "<a>", "<Piece>", "<!--", "<![CDATA[", "("]);
                replace(file, at..at, open.repeat(*random.choose(&[1, 33, 200, 5000])).as_bytes());
            }
            21 => {
                let start = word_start(file, at);
                let end = (start..file.len()).find(|&i| !file[i].is_ascii_alphanumeric()).unwrap_or(file.len());
                replace(file, start..end, random.choose(self.words).as_bytes());
            }
            22 => replace(file, at..at, random.choose(self.words).as_bytes()),
            _ => {
                // A run of one byte.
                let end = (at + 1 + random.below(64)).min(file.len());
                file.get_mut(at..end).unwrap_or_default().fill(*random.choose(b"\0\xff 09A"));
            }
        }
    }

    /// The end of another file in place of this one's, both cut at a line or tag if one follows.
    fn splice(&self, file: &mut Vec<u8>, at: usize, random: &mut Random) {
        let other = random.choose(self.seeds);
        let cut = |file: &[u8], at: usize| {
            let next = file[at..].iter().position(|byte| b"<\n,".contains(byte));
            next.map_or(at, |next| at + next)
        };
        let from = cut(other, random.below(other.len()));
        let to = cut(file, at);
        file.truncate(to);
        file.extend_from_slice(&other[from..]);
    }
}

fn replace(file: &mut Vec<u8>, range: Range<usize>, with: &[u8]) {
    if with.len() <= LONGEST {
        file.splice(range, with.iter().copied());
    }
}

/// The bytes of both ranges change places, where both are there and apart.
fn swap(file: &mut Vec<u8>, first: Option<Range<usize>>, second: Option<Range<usize>>) {
    let (Some(a), Some(b)) = (first, second) else { return };
    let (a, b) = if a.start <= b.start { (a, b) } else { (b, a) };
    if a.end > b.start {
        return;
    }
    let (left, right) = (file[a.clone()].to_vec(), file[b.clone()].to_vec());
    replace(file, b, &left);
    replace(file, a, &right);
}

/// A binary word of one to eight bytes, in either order, becomes another.
fn word(file: &mut [u8], at: usize, random: &mut Random) {
    let size = *random.choose(&[1, 2, 4, 8]);
    let Some(place) = file.get_mut(at..at + size) else { return };
    let mut little = [0; 8];
    little[..size].copy_from_slice(place);
    let value = match random.below(3) {
        0 => u64::from_le_bytes(little).wrapping_add(random.choose(WORDS).wrapping_sub(2)),
        _ => *random.choose(WORDS),
    };
    place.copy_from_slice(&value.to_le_bytes()[..size]);
    if random.below(2) == 0 {
        place.reverse();
    }
}

/// The number in text that begins at `at` or after.
fn number_after(file: &[u8], at: usize) -> Option<Range<usize>> {
    let start = at + file.get(at..)?.iter().position(u8::is_ascii_digit)?;
    let is_part = |byte: u8| byte.is_ascii_digit() || b".eE+-".contains(&byte);
    let start = (0..start).rev().take_while(|&i| is_part(file[i])).last().unwrap_or(start);
    let end = (start..file.len()).find(|&i| !is_part(file[i])).unwrap_or(file.len());
    Some(start..end)
}

fn word_start(file: &[u8], at: usize) -> usize {
    (0..at.min(file.len())).rev().take_while(|&i| file[i].is_ascii_alphanumeric()).last().unwrap_or(at)
}

fn tag_after(file: &[u8], at: usize) -> Option<Range<usize>> {
    let start = at + file.get(at..)?.iter().position(|&byte| byte == b'<')?;
    let end = start + file[start..].iter().position(|&byte| byte == b'>')? + 1;
    Some(start..end)
}

fn line_after(file: &[u8], at: usize) -> Option<Range<usize>> {
    let start = at + file.get(at..)?.iter().position(|&byte| byte == b'\n')? + 1;
    let end = file[start..].iter().position(|&byte| byte == b'\n').map_or(file.len(), |length| start + length + 1);
    (end - start < 1 << 16).then_some(start..end)
}

/// The next ` name="value"`.
fn attribute_after(file: &[u8], at: usize) -> Option<(Range<usize>, Range<usize>)> {
    let equals = at + file.get(at..)?.windows(2).position(|pair| pair == b"=\"" || pair == b"='")?;
    let start = (0..equals).rev().find(|&i| file[i].is_ascii_whitespace())?;
    let quote = file[equals + 1];
    let value = equals + 2;
    let end = value + file[value..].iter().position(|&byte| byte == quote)?;
    Some((start..end + 1, value..end))
}

/// An attribute goes, comes twice, or takes the value of another or an absurd one.
fn attribute(file: &mut Vec<u8>, at: usize, random: &mut Random) {
    let Some((whole, value)) = attribute_after(file, at) else { return };
    match random.below(5) {
        0 => replace(file, whole, b""),
        1 => {
            let text = file[whole.clone()].to_vec();
            replace(file, whole, &text.repeat(2));
        }
        2 => replace(file, value, random.choose(NUMBERS).as_bytes()),
        3 => replace(file, value, b"&a;&#0;&#x110000;&lt;"),
        _ => {
            let other = attribute_after(file, random.below(file.len())).map(|(_, value)| file[value].to_vec());
            replace(file, value, &other.unwrap_or_default());
        }
    }
}
