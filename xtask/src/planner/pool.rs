//! Skills and engines for measurements. Knows the format of libraries.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use anyhow::Result;
use serde_json::{Value, json};

use super::problems::Skills;

/// A script that succeeds at once.
pub(super) const DONE: &str = "def execute(self, inputs, outputs, gvm):\n    return \"success\"\n";

/// Writes skills as libraries with this common script.
pub(super) fn write(folder: &Path, skills: Skills, script: &str) -> Result<()> {
    for (name, action) in skills {
        let annotation = json!({"pddl_action": action, "pddl_predicates": "", "pddl_types": "", "requirements": [], "description": ""});
        let notes = json!({"RAFCONTPP": {"PDDL_ACTION": annotation}});
        library(&folder.join(name), &json!({}), script)?;
        fs::write(folder.join(name).join("semantic_data.json"), notes.to_string())?;
    }
    Ok(())
}

/// Writes a library with a constant output `facts`.
pub(super) fn observer(folder: &Path, facts: &str) -> Result<()> {
    let port = json!({
        "__jsonqualname__": "rafcon.core.state_elements.data_port.OutputDataPort", "data_port_id": 0,
        "data_type": {"__type__": "__builtin__.str"}, "default_value": "", "name": "facts",
    });
    let script = format!(
        "def execute(self, inputs, outputs, gvm):\n    outputs[\"facts\"] = {}\n    return \"success\"\n",
        Value::from(facts)
    );
    library(folder, &json!({"0": port}), &script)
}

fn library(folder: &Path, outputs: &Value, script: &str) -> Result<()> {
    fs::create_dir_all(folder)?;
    let outcome = |id: i64, name: &str| json!({"__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", "name": name, "outcome_id": id});
    let core = json!({
        "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", "description": null,
        "name": folder.file_name().unwrap_or_default().to_string_lossy(), "state_id": "SKILLX",
        "income": {"__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"}, "input_data_ports": {},
        "output_data_ports": outputs,
        "outcomes": {"-2": outcome(-2, "preempted"), "-1": outcome(-1, "aborted"), "0": outcome(0, "success")},
    });
    let header = json!({"creation_time": "2026-01-01 00:00:00", "used_rafcon_version": "2.1.1", "version": null, "root_state_storage_id": ""});
    fs::write(folder.join("statemachine.json"), header.to_string())?;
    fs::write(folder.join("core_data.json"), core.to_string())?;
    Ok(fs::write(folder.join("script.py"), script)?)
}

/// An engine that prints one plan at once; returns the interpreter next to it.
pub(super) fn engine_that_says(folder: &Path, plan: &Value) -> Result<PathBuf> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("plan.json"), format!("{plan}\n"))?;
    engine(folder, &format!("exec cat {}", folder.join("plan.json").display()))
}

/// An engine that runs a shell script; returns the interpreter next to it.
pub(super) fn engine(folder: &Path, shell: &str) -> Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let program = folder.join("kairos");
    fs::write(&program, format!("#!/bin/sh\n{shell}\n"))?;
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755))?;
    Ok(folder.join("python3"))
}
