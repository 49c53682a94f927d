//! Mapping of ROS names to DDS.

use crate::types::{Sort, TypeName};

/// The DDS topic of a topic.
pub(crate) fn topic(name: &str) -> String {
    format!("rt{name}")
}

/// The DDS topics of the requests and the responses of a service.
pub(crate) fn service(name: &str) -> (String, String) {
    (format!("rq{name}Request"), format!("rr{name}Reply"))
}

/// The DDS type of a message: `std_msgs::msg::dds_::String_`.
pub(crate) fn message_type(full: &str) -> Result<String, String> {
    let name = TypeName::parse(full)?;
    Ok(format!("{}::{}::dds_::{}_", name.package, name.sort.word(), name.name))
}

/// The ROS name of a DDS type, if it is one of ROS.
pub(crate) fn plain_type(dds: &str) -> Option<String> {
    let parts: Vec<&str> = dds.split("::").collect();
    let [package, sort, "dds_", name] = parts[..] else { return None };
    Sort::of(sort)?;
    Some(format!("{package}/{sort}/{}", name.strip_suffix('_')?))
}

/// The ROS topic of a DDS topic.
pub(crate) fn plain_topic(dds: &str) -> Option<&str> {
    dds.strip_prefix("rt").filter(|name| name.starts_with('/'))
}

/// The name and the type of the service whose requests use a DDS topic.
pub(crate) fn plain_service(dds: &str, dds_type: &str) -> Option<(String, String)> {
    let name =
        dds.strip_prefix("rq")?.strip_suffix("Request").filter(|name| name.starts_with('/'))?;
    let request = plain_type(dds_type)?;
    Some((name.to_owned(), request.strip_suffix("_Request")?.to_owned()))
}

/// Checks that `name` is an absolute name of a topic, service, action or node.
pub(crate) fn check(name: &str) -> Result<(), String> {
    let part = |part: &str| {
        part.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let fine =
        name.strip_prefix('/').is_some_and(|rest| rest.split('/').all(part)) && name.len() < 240;
    if fine {
        Ok(())
    } else {
        Err(format!("`{name}` is no absolute name: write it like `/robot/scan`"))
    }
}

#[cfg(test)]
mod tests {
    use super::{check, message_type, plain_service, plain_topic};

    #[test]
    fn names_are_written_as_other_nodes_write_them() {
        assert_eq!(
            message_type("std_msgs/msg/String").as_deref(),
            Ok("std_msgs::msg::dds_::String_")
        );
        assert_eq!(plain_topic("rt/robot/scan"), Some("/robot/scan"));
        assert_eq!(plain_topic("ros_discovery_info"), None);
        let service =
            plain_service("rq/addRequest", "example_interfaces::srv::dds_::AddTwoInts_Request_");
        assert_eq!(
            service,
            Some(("/add".to_owned(), "example_interfaces/srv/AddTwoInts".to_owned()))
        );
    }

    #[test]
    fn names_that_ros_does_not_take_are_refused() {
        for wrong in ["", "/", "scan", "/robot//scan", "/robot/", "/1", "/a b", "/a\0"] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
        assert_eq!(check("/robot_1/_hidden"), Ok(()));
    }
}
