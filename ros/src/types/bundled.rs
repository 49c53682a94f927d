//! The interfaces contained in this program. `ros/NOTICE` names their sources.

macro_rules! packages {
    ($($name:literal),+ $(,)?) => {
        /// Each package with its interfaces in sequence, each below a line `== msg/Name`.
        const PACKAGES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../interfaces/", $name, ".txt")))),+];
    };
}

packages![
    "action_msgs",
    "actionlib_msgs",
    "builtin_interfaces",
    "diagnostic_msgs",
    "example_interfaces",
    "geometry_msgs",
    "lifecycle_msgs",
    "moveit_msgs",
    "nav2_msgs",
    "nav_msgs",
    "object_recognition_msgs",
    "octomap_msgs",
    "rafcon_msgs",
    "rcl_interfaces",
    "rmw_dds_common",
    "rosgraph_msgs",
    "sensor_msgs",
    "service_msgs",
    "shape_msgs",
    "std_msgs",
    "std_srvs",
    "stereo_msgs",
    "tf2_msgs",
    "trajectory_msgs",
    "type_description_interfaces",
    "unique_identifier_msgs",
    "visualization_msgs",
];

/// The text of the interface file `package/sort/name`, if this program contains it.
pub(super) fn find(package: &str, sort: &str, name: &str) -> Option<&'static str> {
    let (_, text) = PACKAGES.iter().find(|(known, _)| *known == package)?;
    interfaces(text)
        .find(|(known, _)| known.split_once('/') == Some((sort, name)))
        .map(|(_, body)| body)
}

/// The full names of all interfaces.
pub(crate) fn names() -> impl Iterator<Item = String> {
    PACKAGES.iter().flat_map(|(package, text)| {
        interfaces(text).map(move |(name, _)| format!("{package}/{name}"))
    })
}

/// The interfaces of a package: `msg/Name` and text.
fn interfaces(text: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    text.split("== ").skip(1).map(|part| part.split_once('\n').unwrap_or((part, "")))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::parse;
    use super::find;
    use crate::types::Sort;

    /// Users build that package, so the bundled copy must be identical.
    #[test]
    fn the_types_of_the_bridge_are_those_of_their_package() {
        // The manifest may be a copy in another folder.
        let package = Path::new(file!()).ancestors().nth(3).unwrap().join("rafcon_msgs");
        let sorts = [("msg", Sort::Message), ("srv", Sort::Service), ("action", Sort::Action)];
        let mut count = 0;
        for (word, sort) in sorts {
            for file in std::fs::read_dir(package.join(word)).unwrap() {
                let path = file.unwrap().path();
                let name = path.file_stem().unwrap().to_str().unwrap();
                let text = std::fs::read_to_string(&path).unwrap();
                let bundled =
                    find("rafcon_msgs", word, name).unwrap_or_else(|| panic!("{name} is not here"));
                let parse = |text| parse::file(text, "rafcon_msgs", sort, name).unwrap();
                assert_eq!(parse(&text), parse(bundled), "{name}");
                count += 1;
            }
        }
        let here = super::names().filter(|name| name.starts_with("rafcon_msgs/")).count();
        assert_eq!(count, here);
    }
}
