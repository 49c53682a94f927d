//! The order of the crates: who may depend on whom.
//!
//! Reads what cargo knows, so that a dependency that does not stand here cannot be added unnoticed.

use std::process::Command;

use serde_json::Value;

/// What only tests use: any package may name it for its tests, none for what it ships.
const TESTKIT: &str = "rafcon-testkit";

/// Each package and the packages of this workspace that it may name, for building and for testing.
const LAYERS: [(&str, &[&str]); 17] = [
    ("rafcon-model", &[]),
    // Bytes and numbers only.
    ("rafcon-events", &[]),
    ("rafcon-link", &["rafcon-events"]),
    // For tests, benches and examples of all others ([`TESTKIT`]).
    (
        TESTKIT,
        &["rafcon-storage", "rafcon-engine", "rafcon-link", "rafcon-protocol", "rafcon-model"],
    ),
    // Knows nothing but locks.
    ("rafcon-locks", &[]),
    // The journal keeps the events of the protocol, so storage speaks it.
    ("rafcon-storage", &["rafcon-events", "rafcon-protocol", "rafcon-model"]),
    ("rafcon-engine", &["rafcon-model"]),
    ("rafcon-protocol", &["rafcon-model"]),
    (
        "rafcon-runner",
        &["rafcon-locks", "rafcon-storage", "rafcon-engine", "rafcon-protocol", "rafcon-model"],
    ),
    (
        "rafcon-python",
        &[
            "rafcon-runner",
            "rafcon-supervisor",
            "rafcon-storage",
            "rafcon-engine",
            "rafcon-protocol",
            "rafcon-model",
        ],
    ),
    // Plans and PDDL, pure.
    ("rafcon-planner", &["rafcon-model"]),
    // What starts runners and follows them, for the two programs that do.
    ("rafcon-supervisor", &["rafcon-planner", "rafcon-storage", "rafcon-protocol", "rafcon-model"]),
    // The one checker of machines, for the two programs that tell people what it finds.
    ("rafcon-check", &["rafcon-storage", "rafcon-protocol", "rafcon-model"]),
    // Starts runners as processes: never the extension, the runner or the engine.
    (
        "rafcon-server",
        &[
            "rafcon-locks",
            "rafcon-supervisor",
            "rafcon-check",
            "rafcon-storage",
            "rafcon-protocol",
            "rafcon-model",
        ],
    ),
    // Carries runs over the link: sockets and folders, never HTTP, never the engine.
    (
        "rafcon-relay",
        &["rafcon-link", "rafcon-supervisor", "rafcon-storage", "rafcon-protocol", "rafcon-model"],
    ),
    // Never the extension and never the runner: it starts them as a process and speaks the protocol.
    (
        "rafcon",
        &[
            "rafcon-relay",
            "rafcon-link",
            "rafcon-server",
            "rafcon-supervisor",
            "rafcon-check",
            "rafcon-engine",
            "rafcon-storage",
            "rafcon-protocol",
            "rafcon-model",
        ],
    ),
    ("xtask", &[]),
];

/// The crates that only one package may name.
const OWNED: [(&str, &str); 5] = [
    ("pyo3", "rafcon-python"),
    ("clap", "rafcon xtask"),
    ("axum", "rafcon-server"),
    ("hyper", "rafcon-server"),
    ("argon2", "rafcon-server"),
];

fn packages() -> Vec<Value> {
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let output = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo prints JSON");
    metadata["packages"].as_array().expect("a list of packages").clone()
}

fn name(value: &Value) -> &str {
    value["name"].as_str().expect("a name")
}

fn dependencies(package: &Value) -> &[Value] {
    package["dependencies"].as_array().expect("a list of dependencies")
}

#[test]
fn every_package_has_its_place() {
    let mut found = packages().iter().map(|package| name(package).to_owned()).collect::<Vec<_>>();
    let mut placed = LAYERS.map(|(package, _)| package.to_owned()).to_vec();
    found.sort();
    placed.sort();
    assert_eq!(found, placed, "the table of layers and the workspace name different packages");
}

#[test]
fn a_package_names_only_lower_layers() {
    for package in &packages() {
        let allowed = LAYERS
            .iter()
            .find(|(layer, _)| *layer == name(package))
            .map_or(&[][..], |(_, allowed)| allowed);
        for dependency in
            dependencies(package).iter().filter(|dependency| dependency["path"].is_string())
        {
            let is_for_tests = dependency["kind"] == "dev";
            let dependency = name(dependency);
            if is_for_tests && dependency == TESTKIT {
                continue;
            }
            assert!(
                allowed.contains(&dependency),
                "{} must not depend on {dependency}",
                name(package)
            );
        }
    }
}

#[test]
fn a_heavy_crate_has_one_door() {
    for package in &packages() {
        for dependency in dependencies(package) {
            let owners = OWNED
                .iter()
                .find(|(owned, _)| *owned == name(dependency))
                .map(|(_, owners)| owners);
            let at_home =
                owners.is_none_or(|owners| owners.split(' ').any(|owner| owner == name(package)));
            assert!(at_home, "{} must not depend on {}", name(package), name(dependency));
        }
    }
}
