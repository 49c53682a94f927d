//! Dense numbers for the things of one run.

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
    /// A place where a state can run: a node seen through all its parents. The same place keeps its number for the run.
    PathId
}
index! {
    /// A line of execution; the root has branch 0, each child of a concurrency state gets one of its own.
    BranchId
}

/// One active run of a state. Numbers are used again after the state is left, with another generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FrameId {
    /// Place in the table of frames.
    pub slot: u32,
    /// How often the place was used before.
    pub generation: u32,
}
