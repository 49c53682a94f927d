//! The interfaces that lie in this program. `ros/NOTICE` says where they come from.

macro_rules! packages {
    ($($name:literal),+ $(,)?) => {
        /// Each package with its interfaces, one after the other, each below a line `== msg/Name`.
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
    "nav_msgs",
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

/// The text of the interface file `package/sort/name`, if it is here.
pub(super) fn find(package: &str, sort: &str, name: &str) -> Option<&'static str> {
    let (_, text) = PACKAGES.iter().find(|(known, _)| *known == package)?;
    interfaces(text)
        .find(|(known, _)| known.split_once('/') == Some((sort, name)))
        .map(|(_, body)| body)
}

/// The full names of all.
pub(crate) fn names() -> impl Iterator<Item = String> {
    PACKAGES.iter().flat_map(|(package, text)| {
        interfaces(text).map(move |(name, _)| format!("{package}/{name}"))
    })
}

/// Each interface of a package: `msg/Name`, and its text.
fn interfaces(text: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    text.split("== ").skip(1).map(|part| part.split_once('\n').unwrap_or((part, "")))
}
