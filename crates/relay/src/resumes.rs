//! Requests of a station's server to resume runs of robots, shared with the station's thread.

use parking_lot::Mutex;
use rafcon_protocol::Answer;
use rafcon_protocol::api::ResumeRun;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

/// Capacity. A further request is refused.
const RESUMES_MAX: usize = 64;

/// Takes the answer to a request.
pub type Answered = Box<dyn FnOnce(Answer) + Send>;

/// A run that its robot is to resume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResumeRequest {
    /// Name of the robot.
    pub robot: String,
    /// Id of the run.
    pub run: String,
    /// Name of the asking user.
    pub user: String,
    /// Content, under an id unique at the station.
    pub asked: ResumeRun,
}

/// The requests to resume runs of robots at a station.
#[derive(Debug, Clone, Default)]
pub struct ResumeDesk(Arc<Mutex<Resumes>>);

#[derive(Default)]
struct Resumes {
    /// Robots that are received here.
    robots: BTreeSet<String>,
    new: Vec<ResumeRequest>,
    waiting: BTreeMap<String, Answered>,
}

impl fmt::Debug for Resumes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { robots, new, waiting } = self;
        let waiting = waiting.keys();
        f.debug_struct("Resumes")
            .field("robots", robots)
            .field("new", new)
            .field("waiting", &waiting)
            .finish()
    }
}

impl ResumeDesk {
    /// Asks a robot to resume a run, once for each id. `answered` is called on the station's thread. Returns false if the station does
    /// not receive the robot, or too many requests wait.
    pub fn ask(&self, request: ResumeRequest, answered: Answered) -> bool {
        let mut desk = self.0.lock();
        let is_full = desk.waiting.len() >= RESUMES_MAX;
        if !desk.robots.contains(&request.robot)
            || is_full && !desk.waiting.contains_key(&request.asked.id)
        {
            return false;
        }
        // The last request with this id gets the answer.
        desk.waiting.insert(request.asked.id.clone(), answered);
        desk.new.retain(|new| new.asked.id != request.asked.id);
        desk.new.push(request);
        true
    }

    /// Notes that the station receives this robot.
    pub(crate) fn receive(&self, robot: &str) {
        self.0.lock().robots.insert(robot.to_owned());
    }

    /// Requests for this robot that were not taken before.
    pub(crate) fn take(&self, robot: &str) -> Vec<ResumeRequest> {
        self.0.lock().new.extract_if(.., |request| request.robot == robot).collect()
    }

    /// Delivers the answer to the request with this id.
    pub(crate) fn answer(&self, id: &str, answer: &Answer) {
        let waiting = self.0.lock().waiting.remove(id);
        if let Some(answered) = waiting {
            answered(answer.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{RESUMES_MAX, ResumeDesk, ResumeRequest};
    use rafcon_protocol::api::ResumeRun;
    use rafcon_protocol::{Answer, OnCrash};
    use std::sync::mpsc::sync_channel;

    fn request(robot: &str, nth: usize) -> ResumeRequest {
        let asked = ResumeRun { id: format!("ana/{nth}"), policy: OnCrash::Ask, from: None };
        ResumeRequest {
            robot: robot.to_owned(),
            run: "r".to_owned(),
            user: "ana".to_owned(),
            asked,
        }
    }

    #[test]
    fn a_request_is_taken_once_and_its_answer_reaches_who_asked_last() {
        let desk = ResumeDesk::default();
        let (answer, answered) = sync_channel(8);
        let ask = |robot: &str, nth, word: &'static str| {
            let answer = answer.clone();
            let said = Box::new(move |it| answer.send((word, it)).unwrap_or_default());
            desk.ask(request(robot, nth), said)
        };
        assert!(!ask("scout", 1, "not received"));
        desk.receive("scout");
        assert!(ask("scout", 1, "first") && ask("scout", 1, "second"));
        assert_eq!((desk.take("mule"), desk.take("scout")), (vec![], vec![request("scout", 1)]));
        assert_eq!(desk.take("scout"), []);
        desk.answer("ana/1", &Answer::Applied);
        desk.answer("ana/1", &Answer::Expired);
        assert_eq!(answered.try_iter().collect::<Vec<_>>(), [("second", Answer::Applied)]);
    }

    #[test]
    fn beyond_the_bound_requests_are_refused_until_one_is_answered() {
        let desk = ResumeDesk::default();
        desk.receive("scout");
        let ask = |nth| desk.ask(request("scout", nth), Box::new(|_| {}));
        assert!((0..RESUMES_MAX).all(ask));
        assert!(!ask(RESUMES_MAX) && ask(0));
        desk.answer("ana/0", &Answer::Applied);
        assert!(ask(RESUMES_MAX));
    }
}
