//! Base64 as VTK files hold it: several encodings one after the other, each padded by itself, white space anywhere.

/// Marks a byte that is no digit of base64.
const NONE: u8 = 0xff;

const DIGITS: [u8; 256] = {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut table = [NONE; 256];
    let mut digit = 0;
    while digit < alphabet.len() {
        table[alphabet[digit] as usize] = digit as u8;
        digit += 1;
    }
    table
};

/// Decodes group by group; padding ends a group early and the next one follows.
#[derive(Clone, Debug)]
pub(super) struct Base64<'a> {
    text: &'a [u8],
    /// Bytes of the last group that were not asked for yet; they are its last ones.
    group: [u8; 3],
    left: usize,
}

impl<'a> Base64<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, group: [0; 3], left: 0 }
    }

    /// The stream without the first `characters` of its text.
    pub(super) fn skipping(&self, characters: usize) -> Option<Self> {
        self.text.get(characters..).map(Self::new)
    }

    /// No more bytes than these can follow.
    pub(super) fn at_most(&self) -> usize {
        self.text.len() / 4 * 3 + 3 + self.left
    }

    /// The next `count` bytes; `None` where the text ends or something else than base64 follows.
    pub(super) fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        if count > self.at_most() {
            return None;
        }
        let mut bytes = Vec::with_capacity(count + 2);
        while bytes.len() < count {
            if self.left == 0 {
                self.next_group()?;
            }
            let wanted = self.left.min(count - bytes.len());
            let start = 3 - self.left;
            bytes.extend_from_slice(&self.group[start..start + wanted]);
            self.left -= wanted;
        }
        Some(bytes)
    }

    fn next_group(&mut self) -> Option<()> {
        let mut digits = [0_u8; 4];
        let mut count = 0;
        let mut padding = 0;
        while count + padding < 4 {
            let (&byte, rest) = self.text.split_first()?;
            self.text = rest;
            match DIGITS[usize::from(byte)] {
                _ if byte.is_ascii_whitespace() => {}
                NONE if byte == b'=' && count >= 2 => padding += 1,
                digit if digit != NONE && padding == 0 => {
                    digits[count] = digit;
                    count += 1;
                }
                _ => return None,
            }
        }
        let [a, b, c, d] = digits.map(u32::from);
        let [_, x, y, z] = (a << 18 | b << 12 | c << 6 | d).to_be_bytes();
        self.left = 3 - padding;
        self.group = match padding {
            0 => [x, y, z],
            1 => [0, x, y],
            _ => [0, 0, x],
        };
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::Base64;

    #[test]
    fn padded_pieces_follow_each_other() {
        let mut stream = Base64::new(b" CAA A\nAA== /+8=AQID<");
        assert_eq!(stream.take(4).unwrap(), [8, 0, 0, 0]);
        assert_eq!(stream.take(3).unwrap(), [0xff, 0xef, 1]);
        assert_eq!(stream.take(2).unwrap(), [2, 3]);
        assert!(stream.take(0).unwrap().is_empty());
        assert!(stream.take(1).is_none());
    }

    #[test]
    fn what_is_no_base64_ends_the_stream() {
        for text in [&b"A==="[..], b"====", b"AA=A", b"AA!A", b"AAA"] {
            assert!(Base64::new(text).take(1).is_none(), "{text:?}");
        }
        assert!(Base64::new(b"AAAA").take(usize::MAX).is_none());
    }
}
