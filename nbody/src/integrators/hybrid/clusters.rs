//! Clusters: bodies that are joined by pairs of neighbours, directly or through others.
//!
//! Members of a cluster ascend, clusters come in the order of their first members: the same for any order of the pairs.

use std::ops::Range;

/// The clusters of the bodies that have neighbours; keeps its buffers between calls.
#[derive(Debug, Default)]
pub struct Clusters {
    /// Places of all members, cluster by cluster.
    pub members: Vec<u32>,
    /// Where each cluster begins in `members`, and the end.
    starts: Vec<u32>,
    /// A body's link towards the first of its cluster; itself outside of the search.
    link: Vec<u32>,
    /// Which cluster a first body begins.
    number: Vec<u32>,
}

impl Clusters {
    /// Joins `n` bodies by `pairs`.
    pub fn join(&mut self, n: usize, pairs: &[[u32; 2]]) {
        let kept = self.link.len().min(n);
        self.link.truncate(kept);
        self.link.extend(kept as u32..n as u32);
        self.number.resize(n, 0);
        self.members.clear();
        for &[i, j] in pairs {
            self.members.extend([i, j]);
            let (a, b) = (self.first(i), self.first(j));
            self.link[a.max(b) as usize] = a.min(b);
        }
        self.members.sort_unstable();
        self.members.dedup();
        self.starts.clear();
        self.starts.push(0);
        for k in 0..self.members.len() {
            let i = self.members[k];
            let first = self.first(i);
            if first == i {
                self.number[i as usize] = self.starts.len() as u32;
                self.starts.push(0);
            }
            self.starts[self.number[first as usize] as usize] += 1;
        }
        let (link, number) = (&self.link, &self.number);
        let root = |mut i: u32| {
            while link[i as usize] != i {
                i = link[i as usize];
            }
            i
        };
        self.members
            .sort_unstable_by_key(|&i| (number[root(i) as usize], i));
        for k in 1..self.starts.len() {
            self.starts[k] += self.starts[k - 1];
        }
        for &i in &self.members {
            self.link[i as usize] = i;
        }
    }

    /// The first body of i's cluster; shortens the way there.
    fn first(&mut self, mut i: u32) -> u32 {
        while self.link[i as usize] != i {
            let next = self.link[i as usize];
            self.link[i as usize] = self.link[next as usize];
            i = next;
        }
        i
    }

    pub fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Where the k-th cluster stands in `members`.
    pub fn range(&self, k: usize) -> Range<usize> {
        self.starts[k] as usize..self.starts[k + 1] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_are_what_a_walk_along_all_pairs_reaches() {
        let mut clusters = Clusters::default();
        for round in 0..3u32 {
            let n = 300 - 50 * round;
            let f = |k: u32| (f64::from(k + 1000 * round) * 0.618_034).fract() * f64::from(n);
            let mut pairs: Vec<[u32; 2]> = (0..110)
                .map(|k| [f(k) as u32, f(7 * k + 3) as u32])
                .filter(|[i, j]| i != j)
                .collect();
            let mut label: Vec<u32> = (0..n).collect();
            for _ in 0..n {
                for &[i, j] in &pairs {
                    let least = label[i as usize].min(label[j as usize]);
                    (label[i as usize], label[j as usize]) = (least, least);
                }
            }
            let mut expected: Vec<Vec<u32>> = vec![Vec::new(); n as usize];
            for i in 0..n {
                expected[label[i as usize] as usize].push(i);
            }
            expected.retain(|c| c.len() > 1);
            for _ in 0..2 {
                clusters.join(n as usize, &pairs);
                let found: Vec<Vec<u32>> = (0..clusters.count())
                    .map(|k| clusters.members[clusters.range(k)].to_vec())
                    .collect();
                assert_eq!(found, expected);
                pairs.reverse();
            }
        }
        clusters.join(5, &[]);
        assert_eq!(clusters.count(), 0);
    }
}
