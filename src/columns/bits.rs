//! `BitColumn`: one bit per cell, packed in 64-bit words.

use super::Column;

/// One bit per entry, least significant first.
#[derive(Clone, Debug)]
pub struct BitColumn {
    words: Column<u64>,
    len: usize,
}

impl BitColumn {
    /// The bits of `len` entries in `words`; no bit is missing.
    pub(crate) fn from_words(words: Column<u64>, len: usize) -> Option<Self> {
        (words.len() == len.div_ceil(64)).then_some(Self { words, len })
    }

    /// The bit of entry `i`.
    ///
    /// # Panics
    /// If `i` is not below the length.
    #[inline]
    pub fn get(&self, i: usize) -> bool {
        self.view().get(i)
    }

    /// The bits, looked up once: for many reads.
    pub fn view(&self) -> BitView<'_> {
        BitView { words: &self.words }
    }

    /// How many entries there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Bytes of memory that the bits take; none where they are used in place.
    pub fn owned_bytes(&self) -> u64 {
        self.words.owned_bytes()
    }

    /// Whether there is no entry.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// [`BitColumn`] as a slice.
#[derive(Clone, Copy, Debug)]
pub struct BitView<'a> {
    words: &'a [u64],
}

impl BitView<'_> {
    /// The bit of entry `i`.
    ///
    /// # Panics
    /// If `i` is far above the length.
    #[inline]
    pub fn get(self, i: usize) -> bool {
        (self.words[i / 64] >> (i % 64)) & 1 != 0
    }
}

impl FromIterator<bool> for BitColumn {
    fn from_iter<I: IntoIterator<Item = bool>>(bits: I) -> Self {
        let mut words = Vec::new();
        let mut len = 0;
        for bit in bits {
            if len % 64 == 0 {
                words.push(0);
            }
            words[len / 64] |= u64::from(bit) << (len % 64);
            len += 1;
        }
        Self { words: words.into(), len }
    }
}

#[cfg(test)]
mod tests {
    use super::BitColumn;

    #[test]
    fn bits_come_back_around_every_word_border() {
        for len in [0, 1, 63, 64, 65, 129] {
            let bits: BitColumn = (0..len).map(|i| i % 3 == 0).collect();
            assert_eq!(bits.len(), len);
            assert!((0..len).all(|i| bits.get(i) == (i % 3 == 0)));
        }
    }
}
