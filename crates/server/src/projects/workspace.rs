//! Workspaces of colcon: `colcon build --symlink-install` installs links to sources and builds. Knows the files that identify
//! such a workspace.

use super::at_home;
use std::fs;
use std::path::{Path, PathBuf};

/// File that marks the install folder of a workspace.
const INSTALLED: &str = ".colcon_install_layout";
/// File with the name of the program that built a workspace. It is beside the install folder, so a project cannot contain it.
const BUILT_BY: &str = "build/.built_by";

/// The folders outside of a project to which its links may lead: sources and builds of the workspace from which it is installed.
pub(super) fn sources(project: &Path) -> Vec<PathBuf> {
    let installed = project.ancestors().find(|folder| folder.join(INSTALLED).is_file());
    let Some(workspace) = installed.and_then(Path::parent) else { return Vec::new() };
    let builder = fs::read_to_string(workspace.join(BUILT_BY)).unwrap_or_default();
    if builder.trim() != "colcon" {
        return Vec::new();
    }
    vec![at_home(&workspace.join("src")), at_home(&workspace.join("build"))]
}

#[cfg(test)]
mod tests {
    use super::sources;
    use expect_test::{Expect, expect};
    use std::fs;
    use std::path::PathBuf;

    fn check(files: &[(&str, &str)], project: &str, expect: &Expect) {
        let place = tempfile::tempdir().unwrap();
        let place = place.path().canonicalize().unwrap();
        fs::create_dir_all(place.join(project)).unwrap();
        for (file, text) in files {
            let file = place.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        }
        let found = sources(&place.join(project));
        let inside = |folder: &PathBuf| folder.strip_prefix(&place).unwrap().display().to_string();
        expect.assert_eq(&found.iter().map(inside).collect::<Vec<_>>().join(" "));
    }

    #[test]
    fn links_of_an_installed_project_may_lead_to_the_sources_of_its_workspace() {
        let installed = ("ws/install/.colcon_install_layout", "isolated\n");
        let built = ("ws/build/.built_by", "colcon\n");
        let share = "ws/install/p/share/p";
        check(&[installed, built], share, &expect!["ws/src ws/build"]);
        check(&[installed, built], "ws/install", &expect!["ws/src ws/build"]);
        check(&[installed], share, &expect![[""]]);
        check(&[built], share, &expect![[""]]);
        check(&[installed, built], "ws/src", &expect![[""]]);
        let own = ("ws/install/build/.built_by", "colcon\n");
        check(&[installed, own], "ws/install", &expect![[""]]);
    }
}
