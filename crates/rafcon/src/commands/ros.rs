//! `rafcon serve --ros`: the bridge that offers a server's machines to ROS 2.

use crate::failure::complain;
use rafcon_server::Server;
use rafcon_supervisor::{RosBridge, RosBridgeSettings};
use serde_json::json;

/// Starts the bridge of a server. A failure is only reported: the server works without a bridge.
pub(super) fn bridge(server: &Server, namespace: &str, frame: &str) -> Option<RosBridge> {
    let settings = server.state().settings();
    let begun = RosBridge::begin(RosBridgeSettings {
        python: settings.python.clone(),
        environment: settings.environment.clone(),
        told: json!({
            "server": server.url(),
            "fingerprint": server.fingerprint(),
            "token": server.ros_token(),
            "namespace": namespace,
            "frame": frame,
        }),
        tell: complain,
    });
    begun.inspect_err(|error| complain(&format!("the bridge to ROS has no thread: {error}"))).ok()
}
