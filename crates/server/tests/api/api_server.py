"""A real server for the tests of its interface: started with temporary folders, killed, started again, ended."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import urllib.error
import urllib.request

REPOSITORY = pathlib.Path(__file__).resolve().parents[4]
BINARY = os.environ["RAFCON_BINARY"]


class ApiServer:
    """`rafcon serve` on a copy of the examples."""

    def __init__(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)
        shutil.copytree(REPOSITORY / "examples", self.folder / "examples")
        self.process, self.link = None, None
        self.begin("127.0.0.1:0")

    def begin(self, bind):
        """Starts a server and waits until it says where it listens."""
        folders = [f"--state={self.folder}/state", f"--runs={self.folder}/runs"]
        examples = self.folder / "examples"
        command = [BINARY, "serve", examples, "--keep-token", "--bind", bind]
        command += ["--library-path", f"library={examples}/libraries"]
        self.process = subprocess.Popen(command + folders, stdout=subprocess.PIPE, text=True)
        self.link = self.process.stdout.readline().strip()
        self.url, _, self.token = self.link.partition("/?token=")

    def kill(self):
        """Ends the server as a power cut would."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def again(self):
        """Starts the next server where the last one was."""
        self.begin(self.url.split("//")[1])

    def request(self, method, path, body=None):
        """One request; the body of its answer."""
        data = None if body is None else json.dumps(body).encode()
        headers = {"Authorization": f"Bearer {self.token}", "Content-Type": "application/json"}
        request = urllib.request.Request(f"{self.url}/api/v1{path}", data, headers, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)

    def history(self, run):
        """Every event of a run, as its journal has them."""
        command = [BINARY, "history", run, "--json", f"--runs={self.folder}/runs"]
        lines = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        return [json.loads(line) for line in lines.splitlines()]

    def end(self):
        """Ends every run, then the server."""
        for run in self.request("GET", "/runs"):
            if run["phase"] in ("starting", "live"):
                self.finish(run["id"])
        self.process.send_signal(signal.SIGTERM)
        self.process.communicate()
        self.place.cleanup()

    def finish(self, run):
        """Kills a run; one that has just ended needs no more."""
        try:
            command = {"id": f"end-{run}", "command": {"type": "kill"}}
            self.request("POST", f"/runs/{run}/commands", command)
        except urllib.error.HTTPError as error:
            error.close()
