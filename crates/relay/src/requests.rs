//! Requests of a station's server to start and resume runs of robots, shared with the station's thread.

use parking_lot::Mutex;
use rafcon_protocol::api::{RobotAnswer, RobotRequest};
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::sync::Arc;

/// Capacity for each robot. A further request is refused.
const REQUESTS_MAX: usize = 64;
/// Capacity of the repetitions of a request that wait for its answer. Of more, the oldest is dropped and has to be repeated.
const REPEATED_MAX: usize = 4;

/// Takes the answer to a request.
pub type Answered = Box<dyn FnOnce(RobotAnswer) + Send>;

/// Reason why a request was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotTaken {
    /// The station does not receive this robot.
    #[error("this server does not receive the robot now: run it as its station (`rafcon station`)")]
    NotReceived,
    /// Too many requests wait.
    #[error("64 requests to start or resume runs wait for the robot: wait until some are answered")]
    Full,
}

/// The requests of a station's server to robots.
#[derive(Debug, Clone, Default)]
pub struct RequestBroker(Arc<Mutex<BTreeMap<String, Requests>>>);

/// Requests to one robot, by their ids.
#[derive(Default)]
struct Requests {
    new: Vec<RobotRequest>,
    waiting: BTreeMap<String, VecDeque<Answered>>,
}

impl fmt::Debug for Requests {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { new, waiting } = self;
        f.debug_struct("Requests").field("new", new).field("waiting", &waiting.keys()).finish()
    }
}

impl RequestBroker {
    /// Asks a robot for something, once for each id. `answered` is called on the station's thread.
    pub fn ask(
        &self,
        robot: &str,
        request: RobotRequest,
        answered: Answered,
    ) -> Result<(), NotTaken> {
        let mut robots = self.0.lock();
        let requests = robots.get_mut(robot).ok_or(NotTaken::NotReceived)?;
        let id = request.id().to_owned();
        if requests.waiting.len() >= REQUESTS_MAX && !requests.waiting.contains_key(&id) {
            return Err(NotTaken::Full);
        }
        if requests.new.iter().all(|new| new.id() != id) {
            requests.new.push(request);
        }
        let waiting = requests.waiting.entry(id).or_default();
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
    pub(crate) fn take(&self, robot: &str) -> Vec<RobotRequest> {
        let mut robots = self.0.lock();
        robots.get_mut(robot).map(|requests| std::mem::take(&mut requests.new)).unwrap_or_default()
    }

    /// Delivers the answer to the request with this id.
    pub(crate) fn answer(&self, robot: &str, id: &str, answer: &RobotAnswer) {
        let waiting = self.0.lock().get_mut(robot).and_then(|it| it.waiting.remove(id));
        for answered in waiting.into_iter().flatten() {
            answered(answer.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{NotTaken, REPEATED_MAX, REQUESTS_MAX, RequestBroker};
    use rafcon_protocol::OnCrash;
    use rafcon_protocol::api::{
        ResumeRequest, ResumeRun, RobotAnswer, RobotRequest, StartOf, StartRequest,
    };
    use std::sync::mpsc::sync_channel;

    /// Every second one starts a run.
    fn request(nth: usize) -> RobotRequest {
        let (run, user, expiry_ms) = ("r".to_owned(), "ana".to_owned(), None);
        let id = format!("ana/{nth}");
        if nth.is_multiple_of(2) {
            return RobotRequest::Start(StartRequest {
                id,
                user,
                of: StartOf::Again(run, false),
                expiry_ms,
                no_edit: None,
            });
        }
        let asked = ResumeRun { id, policy: OnCrash::Ask, from: None };
        RobotRequest::Resume(ResumeRequest { run, user, asked, expiry_ms })
    }

    fn done() -> RobotAnswer {
        RobotAnswer::Done { run: "r".to_owned() }
    }

    #[test]
    fn a_request_is_taken_once_and_its_answer_reaches_all_who_wait() {
        let broker = RequestBroker::default();
        let (answer, answered) = sync_channel(32);
        let ask = |robot: &str, nth, word: usize| {
            let answer = answer.clone();
            let said = Box::new(move |it| answer.send((word, it)).unwrap_or_default());
            broker.ask(robot, request(nth), said)
        };
        assert_eq!(ask("scout", 1, 0), Err(NotTaken::NotReceived));
        for robot in ["scout", "mule"] {
            broker.receive(robot);
        }
        for word in 0..=REPEATED_MAX {
            assert_eq!(ask("scout", 1, word), Ok(()));
        }
        assert_eq!((broker.take("mule"), broker.take("scout")), (vec![], vec![request(1)]));
        assert_eq!(broker.take("scout"), []);
        broker.answer("mule", "ana/1", &RobotAnswer::Expired);
        broker.answer("scout", "ana/1", &done());
        broker.answer("scout", "ana/1", &RobotAnswer::Expired);
        let all: Vec<_> = (1..=REPEATED_MAX).map(|word| (word, done())).collect();
        assert_eq!(answered.try_iter().collect::<Vec<_>>(), all);
    }

    #[test]
    fn beyond_the_bound_requests_are_refused_until_one_is_answered() {
        let broker = RequestBroker::default();
        for robot in ["scout", "mule"] {
            broker.receive(robot);
        }
        let ask = |robot, nth| broker.ask(robot, request(nth), Box::new(|_| {}));
        assert!((0..REQUESTS_MAX).all(|nth| ask("scout", nth).is_ok()));
        assert_eq!(ask("scout", REQUESTS_MAX), Err(NotTaken::Full));
        assert_eq!([ask("scout", 0), ask("mule", REQUESTS_MAX)], [Ok(()); 2]);
        broker.answer("scout", "ana/0", &done());
        assert_eq!(ask("scout", REQUESTS_MAX), Ok(()));
    }
}
