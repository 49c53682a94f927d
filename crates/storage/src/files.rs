//! The names of the files that make up a machine (`docs/format.md`, files). Knows names only.

/// Identifies a folder as a machine, and says what concerns the machine as a whole.
pub const HEADER: &str = "statemachine.json";
/// What very old versions wrote instead; no longer read.
pub const YAML_HEADER: &str = "statemachine.yaml";
/// Layout of the machine as a whole.
pub const MACHINE_LAYOUT: &str = "sm_meta_data.json";
/// Where a save is prepared; there only while a save runs, or after it was interrupted.
pub const STAGING: &str = ".rafcon-save";

/// One of the files of a state's folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// The state itself.
    Core,
    /// The Python text of an execution state.
    Script,
    /// The user's notes.
    Semantic,
    /// Where its parts stand on the screen.
    Layout,
}

impl Part {
    /// Every file that is ours in a state's folder.
    pub const ALL: [Self; 4] = [Self::Core, Self::Script, Self::Semantic, Self::Layout];

    /// The file's name.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Core => "core_data.json",
            Self::Script => "script.py",
            Self::Semantic => "semantic_data.json",
            Self::Layout => "meta_data.json",
        }
    }
}
