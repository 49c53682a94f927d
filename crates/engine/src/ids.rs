//! Dense numbers for the parts of one run.

macro_rules! index {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// As an index into a list.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

index! {
    /// A state of the program. The content of a library is one set of nodes, however often it is used.
    NodeId
}
index! {
    /// A place where a state can run: a node together with all its parents. A place keeps its number for the whole run.
    PathId
}
index! {
    /// A line of execution. The root has branch 0; each child of a concurrency state gets a branch of its own.
    BranchId
}

/// One active run of a state. Slots are reused after the state is left, with another generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FrameId {
    /// Index in the table of frames.
    pub slot: u32,
    /// Number of earlier uses of the slot.
    pub generation: u32,
}
