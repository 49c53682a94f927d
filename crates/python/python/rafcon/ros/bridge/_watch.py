"""Polling of a server's runs on a thread of its own, for waiting goals and the topics."""

import threading

from rafcon.ros.bridge._client import NoAnswer, Refused
from rafcon.ros.bridge._mapping import active_states

#: Polling intervals (s) with and without runs in progress.
BUSY_S, IDLE_S = 0.1, 0.5
#: Maximum number of ended runs to report.
_OVER_MAX = 20
_LIVE = ("starting", "live")


class RunNow:
    """Run at the time of the last poll."""

    def __init__(self, summary, snapshot=None, control=None):
        self.id = summary["id"]
        self.name = summary["name"]
        machine = summary.get("machine")
        self.machine = f"{machine['project']}/{machine['path']}" if machine else ""
        self.phase = summary["phase"]
        self.robot = summary.get("robot") or ""
        self.is_live = self.phase in _LIVE
        self.outcome = summary["outcome"]["name"] if self.phase == "finished" else ""
        self.reason = summary.get("reason") or ""
        self.events = summary["events"]
        self.holder = _holder(control or {})
        self.active = tuple(active_states(snapshot)) if self.is_live else ()
        status = (snapshot or {}).get("status")
        #: ``running``, ``paused``, ``stepping``, ``stopping``, or its phase.
        self.status = status if self.is_live and status in ("running", "paused", "stepping", "stopping") else self.phase

    @property
    def shown(self):
        """Published values, for comparison."""
        return self.id, self.machine, self.status, self.outcome, self.active, self.reason


def _holder(control):
    """Holder of control of a run; None if its silence permits others to take control."""
    silent_ms = control.get("now_ms", 0) - control.get("heard_ms", 0)
    return None if silent_ms >= control.get("silence_ms", 0) else control.get("holder")


class Watch:
    """Polls the runs, and wakes threads that wait for one."""

    def __init__(self, client, changed, tell):
        self._client = client
        self._tell = tell
        self._changed = changed
        self._news = threading.Condition()
        self._looking = threading.Lock()
        self._wanted = threading.Event()
        self._runs = {}
        self._closed = False
        #: True if the server did not respond to the last request.
        self.is_blind = False
        self.files_revision = None
        #: Runs of goals; always reported, even when many have ended.
        self.followed = set()

    def look(self):
        """Poll once and wake waiting threads; return the runs."""
        with self._looking:
            return self._look()

    def _look(self):
        status = self._client.get("status")
        runs = [self._looked_at(each) for each in self._told(status["runs"])]
        with self._news:
            before = [each.shown for each in self._runs.values()]
            self._runs = {each.id: each for each in runs}
            self.files_revision = status["files_revision"]
            self._news.notify_all()
        self._changed(runs if before != [each.shown for each in runs] else None)
        return runs

    def _told(self, summaries):
        over = [each for each in summaries if each["phase"] not in _LIVE and each["id"] not in self.followed]
        left_out = {each["id"] for each in over[_OVER_MAX:]}
        return [each for each in summaries if each["id"] not in left_out]

    def _looked_at(self, summary):
        if summary["phase"] not in _LIVE:
            return RunNow(summary)
        try:
            now = self._client.get("runs", summary["id"])
        except Refused:
            return RunNow(summary)
        return RunNow(now["run"], now.get("snapshot"), {**now["control"], "now_ms": now["now_ms"]})

    def run(self):
        """Poll until ``close``."""
        told = None
        while not self._closed:
            pause_s = IDLE_S
            try:
                pause_s = BUSY_S if any(each.is_live for each in self.look()) else IDLE_S
                told, self.is_blind = None, False
            except (NoAnswer, Refused) as error:
                self.is_blind = True
                if str(error) != told:
                    told = str(error)
                    self._tell(f"the runs are not known at the moment: {error}")
            self._wanted.wait(pause_s)
            self._wanted.clear()

    def now(self):
        """Poll again without a pause."""
        self._wanted.set()

    def close(self):
        """Stop polling and wake waiting threads."""
        self._closed = True
        self._wanted.set()
        with self._news:
            self._news.notify_all()

    def find(self, run):
        """Run as of the last poll, or None."""
        with self._news:
            return self._runs.get(run)

    def wait(self, seconds):
        """Wait for the next poll, at most this time (s)."""
        with self._news:
            self._news.wait(seconds)
