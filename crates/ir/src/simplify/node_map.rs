//! A table with an optional entry for each node of a growing graph.

use crate::graph::NodeId;

/// Entries by node. Most nodes have one, so they are found by index, not by hash.
pub(super) struct NodeMap<T>(Vec<Option<Box<T>>>);

impl<T> Default for NodeMap<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> NodeMap<T> {
    /// The entry of node `id`, if it has one.
    pub(super) fn get(&self, id: NodeId) -> Option<&T> {
        self.0.get(id.index())?.as_deref()
    }

    /// Gives node `id` an entry unless it has one.
    pub(super) fn insert_new(&mut self, id: NodeId, entry: impl FnOnce() -> T) {
        if self.0.len() <= id.index() {
            self.0.resize_with(id.index() + 1, || None);
        }
        self.0[id.index()].get_or_insert_with(|| Box::new(entry()));
    }
}
