//! Starting a run: what is asked is checked, written down, and begun once, however often it is asked for.
//!
//! Knows requests and folders of runs. Must never know what becomes of a run afterwards.

use super::launch::{LaunchError, Launched, launch};
use super::life;
use super::request::Request;
use super::run::Run;
use crate::access::{Who, of_start};
use crate::blocking::blocking;
use crate::failure::reason;
use crate::{Failure, House};
use axum::http::StatusCode;
use rafcon_protocol::api::{RunSummary, StartRun};
use rafcon_protocol::{Keeping, Launch};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Starts the run, or finds the one that was started by this id. It goes on also if whoever asks goes away meanwhile.
pub(crate) async fn start(
    house: &Arc<House>,
    who: &Who,
    asked: StartRun,
) -> Result<RunSummary, Failure> {
    check(&asked)?;
    who.must(of_start(&asked))?;
    let (house, author) = (Arc::clone(house), who.user.clone());
    let started = tokio::spawn(async move { once(&house, &author, asked).await });
    started.await.unwrap_or_else(|_stopped| Err(unfinished()))
}

fn unfinished() -> Failure {
    let message = "the server could not finish this request: ask again with the same id";
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "not_finished", message)
}

/// What is wrong with a request by itself.
fn check(asked: &StartRun) -> Result<(), Failure> {
    crate::request_id::check(&asked.id)?;
    if asked.keeping == Keeping::Off {
        let message = "a run under a server is kept, or nobody could follow it: ask for `full` or `status`, or use \
                       `rafcon run --keep off`";
        return Err(Failure::bad("keeping_off", message));
    }
    Ok(())
}

async fn once(house: &Arc<House>, author: &str, asked: StartRun) -> Result<RunSummary, Failure> {
    house.runs.are_known().await;
    let id = Request::start_key(author, &asked.id);
    let slot = house.runs.request(&id);
    let mut begun = slot.lock().await;
    if let Some(run) = &*begun {
        return Ok(house.runs.get(run).await.map_err(|_gone| is_gone(run))?.summary());
    }
    match begin(house, author, asked).await {
        Ok(run) => {
            *begun = Some(run.id().to_owned());
            house.audit().note(author, "run_started", run.id());
            Ok(run.summary())
        }
        Err(failure) => {
            drop(begun);
            house.runs.forget_request(&id, &slot);
            Err(failure)
        }
    }
}

fn is_gone(run: &str) -> Failure {
    let message =
        format!("this request has started the run {run}, which was deleted: choose another id");
    Failure::conflict("run_is_gone", message)
}

async fn begin(house: &Arc<House>, author: &str, asked: StartRun) -> Result<Arc<Run>, Failure> {
    let request = Request::to_start(author, asked.clone());
    let turn = house.runs.turn().await?;
    let here = Arc::clone(house);
    let made = move || {
        let _turn = turn;
        made(&here, &asked, &request)
    };
    let (folder, launched) = blocking(made).await?;
    let found = life::look(house, folder.clone()).await;
    let run = found.ok_or_else(|| not_kept(&folder))?;
    life::follow_ours(house, &run, launched).await;
    let here = Arc::clone(house);
    // Old runs make room behind the back of whoever asks.
    drop(tokio::task::spawn_blocking(move || {
        if let Err(error) = here.runs.folder().give_up_old_ones() {
            (here.settings.tell)(&format!("old runs cannot be deleted: {}", reason(&error)));
        }
    }));
    Ok(run)
}

fn not_kept(folder: &Path) -> Failure {
    let message = format!("the folder of the run that was started is gone: {}", folder.display());
    Failure::conflict("run_is_gone", message)
}

/// Makes the folder and starts the runner. A run that does not begin leaves nothing.
fn made(
    house: &House,
    asked: &StartRun,
    request: &Request,
) -> Result<(PathBuf, Launched), Failure> {
    let machine = house.projects.resolve(&asked.machine)?;
    let name = machine.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = house.runs.folder().make(&name).map_err(|error| no_room(&reason(&error)))?;
    let begun = request
        .write(&folder)
        .map_err(|error| no_room(&format!("cannot write into {}: {error}", folder.display())))
        .and_then(|()| {
            launch(&house.settings, &folder, words(house, machine, asked, &folder))
                .map_err(|error| not_launched(&error))
        });
    match begun {
        Ok(launched) => Ok((folder, launched)),
        Err(failure) => {
            if let Err(error) = fs::remove_dir_all(&folder) {
                (house.settings.tell)(&format!("cannot remove {}: {error}", folder.display()));
            }
            Err(failure)
        }
    }
}

fn no_room(why: &str) -> Failure {
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "no_folder", why)
}

/// What a runner is told.
fn words(house: &House, machine: PathBuf, asked: &StartRun, folder: &Path) -> Launch {
    Launch {
        machine,
        start_from: asked.start_from.clone(),
        afterwards: asked.afterwards,
        inputs: asked.inputs.clone().into_iter().collect(),
        globals: asked.globals.clone().into_iter().collect(),
        libraries: house.settings.libraries.clone(),
        config: house.settings.config.clone(),
        every_event: false,
        run_folder: Some(folder.to_path_buf()),
        keeping: asked.keeping,
        strict: asked.strict,
        size_max: asked.size_max,
        hold: asked.hold,
        breakpoints: asked.breakpoints.clone(),
        on_crash: asked.on_crash,
        resume: None,
        crash: None,
        listen: true,
    }
}

/// Why no run began, as an answer.
pub(super) fn not_launched(error: &LaunchError) -> Failure {
    let (status, code) = match error {
        LaunchError::Load(_) => (StatusCode::UNPROCESSABLE_ENTITY, "load_failed"),
        LaunchError::Ended { .. } | LaunchError::Silent(_) | LaunchError::Begin(_) => {
            (StatusCode::UNPROCESSABLE_ENTITY, "not_started")
        }
        LaunchError::Interpreter(_)
        | LaunchError::Extension(_)
        | LaunchError::Start(_)
        | LaunchError::Thread(_)
        | LaunchError::Frame(_)
        | LaunchError::Version(_) => (StatusCode::SERVICE_UNAVAILABLE, "no_runner"),
    };
    Failure::new(status, code, reason(error))
}
