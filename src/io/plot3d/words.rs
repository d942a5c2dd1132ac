//! The words of a text file.

/// Bytes at the beginning that decide whether a file is text.
const HEAD_BYTES: usize = 4096;
/// Digits that a number in single precision may need to be read back; more are of double precision.
const SINGLE_DIGITS: usize = 9;

/// Whether a file begins like text: a binary one begins with numbers, which have bytes that no text has.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    !head.is_empty() && head.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
}

/// The words of a file and where each begins.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }
}

impl<'a> Iterator for Words<'a> {
    /// The byte at which it begins, and the word.
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.bytes.get(self.position..)?;
        let start = self.position + rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position = start + length;
        Some((start, &rest[..length]))
    }
}

/// What a look at all words of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Survey {
    /// How many there are.
    pub(super) words: u64,
    /// Whether one has more digits than single precision can need.
    pub(super) needs_double: bool,
}

/// Looks at all words.
pub(super) fn survey(bytes: &[u8]) -> Survey {
    let mut survey = Survey { words: 0, needs_double: false };
    for (_, word) in Words::new(bytes) {
        survey.words += 1;
        survey.needs_double |= word.len() > SINGLE_DIGITS && significant_digits(word) > SINGLE_DIGITS;
    }
    survey
}

/// The digits of a number from the first to the last that is not 0, without its exponent.
fn significant_digits(word: &[u8]) -> usize {
    let mantissa = word.iter().take_while(|byte| !byte.is_ascii_alphabetic());
    let digits = mantissa.filter(|byte| byte.is_ascii_digit()).skip_while(|&&digit| digit == b'0');
    digits.enumerate().filter(|&(_, &digit)| digit != b'0').last().map_or(0, |(place, _)| place + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted_and_say_where_they_begin() {
        let words: Vec<_> = Words::new(b" 1 -2.5\r\n\t3e5").collect();
        assert_eq!(words, [(1, &b"1"[..]), (3, b"-2.5"), (10, b"3e5")]);
        assert_eq!(survey(b"1 2 3\n"), Survey { words: 3, needs_double: false });
    }

    #[test]
    fn digits_beyond_single_precision_are_found() {
        for (word, digits) in [
            ("-0.000123456789", 9),
            ("1.234567891E-001", 10),
            ("12045", 5),
            ("0.0000000000", 0),
            ("-2100000.000000", 2),
        ] {
            assert_eq!(significant_digits(word.as_bytes()), digits, "{word}");
        }
        assert!(survey(b"1 0.1234567890123").needs_double);
        assert!(!survey(b"1 1.23456789E+001").needs_double);
    }
}
