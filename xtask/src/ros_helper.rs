//! What lies in `ros/`, a workspace of its own: the program `rafcon-ros`, by which scripts speak ROS where there is no rclpy.
//!
//! It is built with `RustDDS` as published but for a few changes, without which peers of Fast DDS do not learn that something
//! was given back and are found seconds later, large messages take seconds, a run does not hear itself, a process that was
//! stopped and continued hears nothing any more, and the last message of one that ends can be lost. The changed copy lies in the
//! target folder, never in the repository.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::product::Profile;
use crate::{process, workspace};

/// A change: the file, what is there, and what is to be there.
type Change = (&'static str, &'static str, &'static str);

/// Where `RustDDS` keeps what readers have not passed on yet.
const CACHE: &str = "src/structure/dds_cache.rs";

const CHANGES: [Change; 12] = [
    // Fast DDS takes the key of what is gone from the inline QoS only ("too large key-only data" otherwise), as the
    // specification has it. A built-in key is a parameter of 16 bytes before the sentinel of 4.
    (
        "src/rtps/message.rs",
        "DDSData::DisposeByKey { .. } => {\n        param_list.push(Parameter::create_pid_status_info_parameter(",
        "DDSData::DisposeByKey { ref key, .. } => {
        if let Some(guid) = key.value.len().checked_sub(20).and_then(|at| key.value.get(at..at + 16)) {
          param_list.push(Parameter { parameter_id: ParameterId::PID_KEY_HASH, value: guid.to_vec() });
        }
        param_list.push(Parameter::create_pid_status_info_parameter(",
    ),
    // Without it a participant does not find the way to itself where there is only the loopback interface.
    (
        "src/rtps/message_receiver.rs",
        "if source_prefix == GuidPrefix::UNKNOWN || source_prefix == self.own_guid_prefix {\n      return;",
        "if source_prefix == GuidPrefix::UNKNOWN {\n      return;",
    ),
    // Fast DDS (vendor 1.15) answers a reader that asks what there is only if that asks as its own do, by the number 0; else
    // what was published before is there seconds later.
    (
        "src/rtps/reader.rs",
        "reader_sn_state: SequenceNumberSet::new_empty(SequenceNumber::new(1)),\n        count: acknack_count,",
        "reader_sn_state: SequenceNumberSet::new_empty(SequenceNumber::new(
          i64::from(!remote_writer_guid.prefix.as_ref().starts_with(&[1, 15])),
        )),
        count: acknack_count,",
    ),
    // Parts of 256 bytes overflow the sockets of peers at once, and then come at 0.8 MB a second.
    (
        "src/rtps/constant.rs",
        "pub const FRAGMENT_SIZE: usize = 256;",
        "pub const FRAGMENT_SIZE: usize = 32_000;",
    ),
    (
        "src/rtps/constant.rs",
        "pub const REPAIR_BATCH_MAX_BYTES: usize = 8192;",
        "pub const REPAIR_BATCH_MAX_BYTES: usize = 1 << 17;",
    ),
    // A process that was stopped and continued is interrupted where it waits: without these two it hears nothing any more.
    (
        "src/rtps/dp_event_loop.rs",
        "        Ok(_) => {}\n        Err(e) => {\n          error!(\"dp_event_loop poll failed",
        "        Ok(_) => {}
        Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
        Err(e) => {\n          error!(\"dp_event_loop poll failed",
    ),
    (
        "src/discovery/discovery.rs",
        "        Ok(_) => (),\n        Err(e) => {\n          error!(\"Failed in waiting of poll in discovery",
        "        Ok(_) => (),
        Err(e) if e.kind() == std::io::ErrorKind::Interrupted => (),
        Err(e) => {\n          error!(\"Failed in waiting of poll in discovery",
    ),
    // What a writer had confirmed when it went can be read as long as it is kept: else the last response of a server that ends is
    // lost if nobody has read it by then.
    (
        CACHE,
        "  received_reliably_before: BTreeMap<GUID, SequenceNumber>,\n}",
        "  received_reliably_before: BTreeMap<GUID, SequenceNumber>,\n  gone: BTreeMap<GUID, SequenceNumber>,\n}",
    ),
    (
        CACHE,
        "      received_reliably_before: BTreeMap::new(),\n",
        "      received_reliably_before: BTreeMap::new(),\n      gone: BTreeMap::new(),\n",
    ),
    (
        CACHE,
        "    self.received_reliably_before.remove(&writer);\n",
        "    if let Some(marker) = self.received_reliably_before.remove(&writer) {
      if self.sequence_numbers.contains_key(&writer) {
        self.gone.insert(writer, marker);
      }
    }\n",
    ),
    (
        CACHE,
        "      .get(&writer)\n      .cloned()\n      .unwrap_or(SequenceNumber::default())",
        "      .get(&writer)\n      .or_else(|| self.gone.get(&writer))\n      .cloned()\n      .unwrap_or(SequenceNumber::default())",
    ),
    (
        CACHE,
        "      self.sequence_numbers.remove(&cc.writer_guid);\n",
        "      self.sequence_numbers.remove(&cc.writer_guid);\n      self.gone.remove(&cc.writer_guid);\n",
    ),
];

/// What is checked of it wherever the rest is: its format, and that what it depends on is fixed. To compile it takes too long for that.
pub(crate) fn lint() -> Result<()> {
    let lock = workspace::path("ros/Cargo.lock");
    ensure!(lock.exists(), "{} is missing: `cargo xtask ros-helper` writes it", lock.display());
    process::run(process::cargo().current_dir(workspace::path("ros")).args(["fmt", "--check"]))
}

/// Builds it, and puts it beside `rafcon`, where scripts look for it.
pub(crate) fn build(profile: Profile) -> Result<PathBuf> {
    let mut build = cargo("build")?;
    let kind = if profile == Profile::Debug { "debug" } else { "release" };
    build.args((profile != Profile::Debug).then_some("--release"));
    process::run(&mut build)?;
    let name = format!("rafcon-ros{}", std::env::consts::EXE_SUFFIX);
    let beside =
        workspace::target()?.join(if profile == Profile::Symbols { "symbols" } else { kind });
    fs::create_dir_all(&beside)?;
    let (built, program) = (folder()?.join("target").join(kind).join(&name), beside.join(&name));
    // One that runs keeps its file: it cannot be written to, but replaced.
    let new = program.with_extension("new");
    fs::copy(&built, &new)
        .and_then(|_| fs::rename(&new, &program))
        .with_context(|| format!("cannot copy {} to {}", built.display(), program.display()))?;
    Ok(program)
}

/// Builds, lints and tests it by itself; `cargo xtask ros` tests it with peers.
pub(crate) fn test() -> Result<()> {
    lint()?;
    process::run(cargo("clippy")?.args(["--all-targets", "--", "-D", "warnings"]))?;
    process::run(&mut cargo("test")?)?;
    build(Profile::Debug).map(drop)
}

fn folder() -> Result<PathBuf> {
    Ok(workspace::target()?.join("ros-helper"))
}

/// Cargo on the copy of the manifest that uses the changed `RustDDS`.
fn cargo(command: &str) -> Result<Command> {
    let folder = folder()?;
    let manifest = folder.join("Cargo.toml");
    changed(&folder.join("rustdds"))?;
    let own = fs::read_to_string(workspace::path("ros/Cargo.toml"))?;
    let main = workspace::path("ros/src/main.rs");
    let more = format!(
        "\n[[bin]]\nname = \"rafcon-ros\"\npath = {:?}\n\n[patch.crates-io]\nrustdds = {{ path = \"rustdds\" }}\n",
        main.to_string_lossy()
    );
    fs::write(&manifest, own + &more)?;
    fs::copy(workspace::path("ros/Cargo.lock"), folder.join("Cargo.lock"))?;
    let mut cargo = process::cargo();
    cargo.current_dir(workspace::path("ros")).args([command, "--quiet", "--manifest-path"]);
    cargo.arg(manifest).arg("--target-dir").arg(folder.join("target"));
    Ok(cargo)
}

/// Makes the changed copy of `RustDDS`, unless it is there.
fn changed(copy: &Path) -> Result<()> {
    let published = published()?;
    let stamp = copy.join("changed-from");
    let about = format!("{}\n{CHANGES:?}", published.display());
    if fs::read_to_string(&stamp).is_ok_and(|before| before == about) {
        return Ok(());
    }
    if copy.exists() {
        fs::remove_dir_all(copy)?;
    }
    copy_all(&published, copy)?;
    for (file, before, after) in CHANGES {
        let path = copy.join(file);
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let places = text.matches(before).count();
        ensure!(places == 1, "{file} of RustDDS has {places} places like this, not one: {before}");
        fs::write(&path, text.replacen(before, after, 1))?;
    }
    fs::write(stamp, about).map_err(Into::into)
}

/// Where cargo keeps `RustDDS` as published.
fn published() -> Result<PathBuf> {
    let mut metadata = process::cargo();
    metadata.current_dir(workspace::path("ros")).args([
        "metadata",
        "--format-version",
        "1",
        "--locked",
    ]);
    let metadata: Value = serde_json::from_str(&process::text(&mut metadata)?)?;
    let packages = metadata["packages"].as_array().context("cargo knows no packages")?;
    let found = packages.iter().find(|package| package["name"] == "rustdds");
    let manifest = found
        .and_then(|package| package["manifest_path"].as_str())
        .context("rustdds is missing")?;
    Path::new(manifest).parent().map(Path::to_path_buf).context("rustdds has no folder")
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &target)?;
        } else if entry.file_name() != OsStr::new(".cargo-ok") {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
