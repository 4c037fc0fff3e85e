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
    /// All members, ascending.
    all: Vec<u32>,
    /// A member's link towards the first of its cluster, by numbers in `all`.
    link: Vec<u32>,
    /// Which cluster a member is in.
    number: Vec<u32>,
}

impl Clusters {
    /// Members in all, and in the largest cluster.
    pub fn sizes(&self) -> (usize, usize) {
        let sizes = (0..self.count()).map(|k| self.range(k).len());
        (self.members.len(), sizes.max().unwrap_or(0))
    }

    /// Joins bodies by `pairs`.
    pub fn join(&mut self, pairs: &[[u32; 2]]) {
        self.all.clear();
        self.all.extend(pairs.iter().flatten());
        self.all.sort_unstable();
        self.all.dedup();
        self.link.clear();
        self.link.extend(0..self.all.len() as u32);
        for pair in pairs {
            let [a, b] = pair.map(|i| self.first(i));
            self.link[a.max(b) as usize] = a.min(b);
        }
        self.count_off();
        self.members.clear();
        self.members.resize(self.all.len(), 0);
        for (&i, &cluster) in self.all.iter().zip(&self.number) {
            let place = &mut self.starts[cluster as usize];
            self.members[*place as usize] = i;
            *place += 1;
        }
        // Each start has become the next one's.
        self.starts.pop();
        self.starts.insert(0, 0);
    }

    /// Numbers the clusters in the order of their first members, and finds where each begins.
    fn count_off(&mut self) {
        self.number.clear();
        self.starts.clear();
        for k in 0..self.all.len() {
            // Links lead to the front, where they are numbered already.
            let first = self.link[k] as usize;
            if first == k {
                self.number.push(self.starts.len() as u32);
                self.starts.push(0);
            } else {
                self.number.push(self.number[first]);
            }
            self.starts[self.number[k] as usize] += 1;
        }
        let mut begin = 0;
        for start in &mut self.starts {
            (*start, begin) = (begin, begin + *start);
        }
        self.starts.push(begin);
    }

    /// The first member, by its number in `all`, of the cluster of body i; shortens the way there.
    fn first(&mut self, i: u32) -> u32 {
        let place = self.all.partition_point(|&other| other < i);
        let mut k = place as u32;
        while self.link[k as usize] != k {
            let next = self.link[k as usize];
            self.link[k as usize] = self.link[next as usize];
            k = next;
        }
        k
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
                clusters.join(&pairs);
                let found: Vec<Vec<u32>> = (0..clusters.count())
                    .map(|k| clusters.members[clusters.range(k)].to_vec())
                    .collect();
                assert_eq!(found, expected);
                pairs.reverse();
            }
        }
        clusters.join(&[]);
        assert_eq!(clusters.count(), 0);
    }
}
