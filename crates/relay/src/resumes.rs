//! Requests of a station's server to resume runs of robots, shared with the station's thread.

use parking_lot::Mutex;
use rafcon_protocol::Answer;
use rafcon_protocol::api::ResumeRequest;
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::sync::Arc;

/// Capacity for each robot. A further request is refused.
const RESUMES_MAX: usize = 64;
/// Capacity of the repetitions of a request that wait for its answer. Of more, the oldest is dropped and has to be repeated.
const REPEATED_MAX: usize = 4;

/// Takes the answer to a request.
pub type Answered = Box<dyn FnOnce(Answer) + Send>;

/// Reason why a request was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotTaken {
    /// The station does not receive this robot.
    #[error("this server does not receive the robot now: run it as its station (`rafcon station`)")]
    NotReceived,
    /// Too many requests wait.
    #[error("64 requests to resume runs wait for the robot: wait for their answers")]
    Full,
}

/// The requests to resume runs of robots at a station.
#[derive(Debug, Clone, Default)]
pub struct ResumeDesk(Arc<Mutex<BTreeMap<String, Resumes>>>);

/// Requests to one robot, by their ids.
#[derive(Default)]
struct Resumes {
    new: Vec<ResumeRequest>,
    waiting: BTreeMap<String, VecDeque<Answered>>,
}

impl fmt::Debug for Resumes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { new, waiting } = self;
        f.debug_struct("Resumes").field("new", new).field("waiting", &waiting.keys()).finish()
    }
}

impl ResumeDesk {
    /// Asks a robot to resume a run, once for each id. `answered` is called on the station's thread.
    pub fn ask(
        &self,
        robot: &str,
        request: ResumeRequest,
        answered: Answered,
    ) -> Result<(), NotTaken> {
        let mut robots = self.0.lock();
        let resumes = robots.get_mut(robot).ok_or(NotTaken::NotReceived)?;
        let id = request.asked.id.clone();
        if resumes.waiting.len() >= RESUMES_MAX && !resumes.waiting.contains_key(&id) {
            return Err(NotTaken::Full);
        }
        if resumes.new.iter().all(|new| new.asked.id != id) {
            resumes.new.push(request);
        }
        let waiting = resumes.waiting.entry(id).or_default();
        let oldest = if waiting.len() >= REPEATED_MAX { waiting.pop_front() } else { None };
        waiting.push_back(answered);
        drop(robots);
        // Its client wakes up, so the lock is released first.
        drop(oldest);
        Ok(())
    }

    /// Notes that the station receives this robot.
    pub(crate) fn receive(&self, robot: &str) {
        self.0.lock().entry(robot.to_owned()).or_default();
    }

    /// Requests for this robot that were not taken before.
    pub(crate) fn take(&self, robot: &str) -> Vec<ResumeRequest> {
        let mut robots = self.0.lock();
        robots.get_mut(robot).map(|resumes| std::mem::take(&mut resumes.new)).unwrap_or_default()
    }

    /// Delivers the answer to the request with this id.
    pub(crate) fn answer(&self, robot: &str, id: &str, answer: &Answer) {
        let waiting = self.0.lock().get_mut(robot).and_then(|resumes| resumes.waiting.remove(id));
        for answered in waiting.into_iter().flatten() {
            answered(answer.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{NotTaken, REPEATED_MAX, RESUMES_MAX, ResumeDesk, ResumeRequest};
    use rafcon_protocol::api::ResumeRun;
    use rafcon_protocol::{Answer, OnCrash};
    use std::sync::mpsc::sync_channel;

    fn request(nth: usize) -> ResumeRequest {
        let asked = ResumeRun { id: format!("ana/{nth}"), policy: OnCrash::Ask, from: None };
        ResumeRequest { run: "r".to_owned(), user: "ana".to_owned(), asked, expiry_ms: None }
    }

    #[test]
    fn a_request_is_taken_once_and_its_answer_reaches_all_who_wait() {
        let desk = ResumeDesk::default();
        let (answer, answered) = sync_channel(32);
        let ask = |robot: &str, nth, word: usize| {
            let answer = answer.clone();
            let said = Box::new(move |it| answer.send((word, it)).unwrap_or_default());
            desk.ask(robot, request(nth), said)
        };
        assert_eq!(ask("scout", 1, 0), Err(NotTaken::NotReceived));
        for robot in ["scout", "mule"] {
            desk.receive(robot);
        }
        for word in 0..=REPEATED_MAX {
            assert_eq!(ask("scout", 1, word), Ok(()));
        }
        assert_eq!((desk.take("mule"), desk.take("scout")), (vec![], vec![request(1)]));
        assert_eq!(desk.take("scout"), []);
        desk.answer("mule", "ana/1", &Answer::Expired);
        desk.answer("scout", "ana/1", &Answer::Applied);
        desk.answer("scout", "ana/1", &Answer::Expired);
        let all: Vec<_> = (1..=REPEATED_MAX).map(|word| (word, Answer::Applied)).collect();
        assert_eq!(answered.try_iter().collect::<Vec<_>>(), all);
    }

    #[test]
    fn beyond_the_bound_requests_are_refused_until_one_is_answered() {
        let desk = ResumeDesk::default();
        for robot in ["scout", "mule"] {
            desk.receive(robot);
        }
        let ask = |robot, nth| desk.ask(robot, request(nth), Box::new(|_| {}));
        assert!((0..RESUMES_MAX).all(|nth| ask("scout", nth).is_ok()));
        assert_eq!(ask("scout", RESUMES_MAX), Err(NotTaken::Full));
        assert_eq!([ask("scout", 0), ask("mule", RESUMES_MAX)], [Ok(()); 2]);
        desk.answer("scout", "ana/0", &Answer::Applied);
        assert_eq!(ask("scout", RESUMES_MAX), Ok(()));
    }
}
