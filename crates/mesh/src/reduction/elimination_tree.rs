//! Branches of the elimination tree of a sparse factor, which are swept side by side.

use std::mem;
use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Fewest entries of the factor in a branch that is swept beside others.
const LEAST: usize = 1 << 20;

/// A supernode with all its descendants, which come before it without others between them.
///
/// Branches within it that are swept side by side have no entries in each other's rows.
#[derive(Debug)]
pub(super) struct Branch {
    /// Rows of its supernodes.
    pub(super) rows: Range<usize>,
    /// Branches that are swept side by side, in the order of their rows.
    pub(super) branches: Vec<Branch>,
    /// The other supernodes, ascending: they come after the branches.
    pub(super) own: Vec<usize>,
    /// Rows behind the branch that it has entries in.
    pub(super) behind: Vec<usize>,
    /// Number of a row in `behind`, by its distance from the end of the branch.
    places: Vec<u32>,
}

/// A supernode with its descendants while the tree is built.
#[derive(Debug, Default)]
struct Subtree {
    /// First and last supernode, and number of them.
    first: usize,
    last: usize,
    count: usize,
    /// Entries of the factor.
    entries: usize,
    branches: Vec<Branch>,
    own: Vec<usize>,
}

impl Branch {
    /// All supernodes of a factor, under the last one; none of a factor without any.
    pub(super) fn of(factor: &SymbolicSupernodalCholesky<usize>) -> Option<Self> {
        Self::with_branches(factor, LEAST)
    }

    /// The same, with `least` entries in a branch that is swept beside others.
    pub(super) fn with_branches(
        factor: &SymbolicSupernodalCholesky<usize>,
        least: usize,
    ) -> Option<Self> {
        let ends = factor.supernode_end();
        let last = factor.n_supernodes().checked_sub(1)?;
        let mut children: Vec<Vec<Subtree>> = Vec::new();
        children.resize_with(last + 1, Vec::new);
        for number in 0..last {
            let subtree = Subtree::new(factor, number, mem::take(&mut children[number]), least);
            // Parts of the matrix that nothing couples come under the last supernode, too.
            let parent = factor.supernode(number).pattern().iter().min();
            let parent = parent.map_or(last, |&row| ends.partition_point(|&end| end <= row));
            children[parent].push(subtree);
        }
        let all = Subtree::new(factor, last, mem::take(&mut children[last]), least);
        Some(all.into_branch(factor))
    }

    /// Number in `behind` of a row behind the branch.
    #[inline]
    pub(super) fn place(&self, row: usize) -> usize {
        self.places[row - self.rows.end] as usize
    }
}

impl Subtree {
    /// The supernode `last` over its children.
    fn new(
        factor: &SymbolicSupernodalCholesky<usize>,
        last: usize,
        mut children: Vec<Self>,
        least: usize,
    ) -> Self {
        let columns = factor.supernode_end()[last] - factor.supernode_begin()[last];
        let is_branch = |child: &Self| child.entries >= least && child.is_contiguous();
        let are_apart = children.iter().filter(|child| is_branch(child)).count() > 1;
        // The longest list is moved, not copied.
        children.sort_by_key(|child| usize::MAX - child.own.len());
        let mut all = Self { first: last, last, count: 1, ..Self::default() };
        all.entries = columns * (columns + factor.supernode(last).pattern().len());
        for child in children {
            all.first = all.first.min(child.first);
            all.count += child.count;
            all.entries += child.entries;
            if are_apart && is_branch(&child) {
                all.branches.push(child.into_branch(factor));
            } else {
                all.branches.extend(child.branches);
                if all.own.is_empty() {
                    all.own = child.own;
                } else {
                    all.own.extend(child.own);
                }
            }
        }
        all.own.push(last);
        all
    }

    /// True if no other supernode is between those of the subtree.
    fn is_contiguous(&self) -> bool {
        self.last + 1 - self.first == self.count
    }

    fn into_branch(mut self, factor: &SymbolicSupernodalCholesky<usize>) -> Branch {
        self.own.sort_unstable();
        self.branches.sort_by_key(|branch| branch.rows.start);
        let rows = factor.supernode_begin()[self.first]..factor.supernode_end()[self.last];
        let behind = factor.supernode(self.last).pattern().to_vec();
        let reach = behind.iter().max().map_or(0, |&row| row + 1 - rows.end);
        let mut places = vec![u32::MAX; reach];
        for (place, row) in (0..).zip(&behind) {
            places[row - rows.end] = place;
        }
        Branch { rows, branches: self.branches, own: self.own, behind, places }
    }
}
