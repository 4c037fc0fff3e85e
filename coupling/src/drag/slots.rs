//! Slots: the gas particles that a block sees, numbered in ascending order.

/// Which gas particles there are, a bit each, and the number of each.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    marks: Vec<u64>,
    number: Vec<u32>,
    /// ends of the words that have marks
    first: usize,
    end: usize,
}

impl Slots {
    /// Makes room for `gas` gas particles, none of them marked.
    pub fn clear(&mut self, gas: usize) {
        self.marks.resize(gas.div_ceil(64), 0);
        self.number.resize(gas, 0);
        (self.first, self.end) = (usize::MAX, 0);
    }

    #[inline(always)]
    pub fn mark(&mut self, j: &u32) {
        let word = *j as usize / 64;
        self.marks[word] |= 1 << (j % 64);
        self.first = self.first.min(word);
        self.end = self.end.max(word + 1);
    }

    /// Lists the marked gas in ascending order, which numbers it, and removes the marks.
    pub fn number(&mut self, gas: &mut Vec<u32>) {
        gas.clear();
        for word in self.first..self.end {
            let mut marks = std::mem::take(&mut self.marks[word]);
            while marks != 0 {
                let j = word as u32 * 64 + marks.trailing_zeros();
                self.number[j as usize] = gas.len() as u32;
                gas.push(j);
                marks &= marks - 1;
            }
        }
    }

    /// Number of a gas particle that was marked.
    #[inline(always)]
    pub fn of(&self, j: u32) -> u32 {
        self.number[j as usize]
    }
}
