"""What a CI job talks to: a package registry like GitLab's and a git repository over HTTP, both in one server, which can
fail in the ways that such servers do.

A failure is (PART, KIND, TIMES): requests whose method and path contain PART fail so many times, in one of these ways:
  502      answers Bad Gateway
  cut      closes the connection in the middle of the answer, or before one
  silence  keeps the connection open and says nothing
  lies     answers a PUT as if it had stored it
"""

import http.server
import os
import subprocess
import threading

TOKEN = "the token of a job"
PACKAGE = "/api/v4/projects/7/packages/generic/octant-nightly/1/history.tar.gz"
ALWAYS = 10**9
# Longest silence; a client that waits for it has no limit of its own.
LIMIT_S = 300


class Server(http.server.ThreadingHTTPServer):
    """Registry with one package, and the repositories of a folder below /git/."""

    daemon_threads = True

    def __init__(self, repositories, stored=None):
        super().__init__(("127.0.0.1", 0), Handler)
        self.repositories, self.stored = repositories, stored
        self.failures, self.requests, self.lock = [], [], threading.Lock()
        self.closing = threading.Event()
        threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        self.url = f"http://127.0.0.1:{self.server_address[1]}"

    def fail(self, part, kind, times=ALWAYS):
        self.failures.append([part, kind, times])

    def failure(self, asked):
        with self.lock:
            self.requests.append(asked)
            for failure in self.failures:
                if failure[0] in asked and failure[2] > 0:
                    failure[2] -= 1
                    return failure[1]
        return None

    def close(self):
        self.closing.set()
        self.shutdown()
        self.server_close()


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def body(self):
        if self.headers.get("Transfer-Encoding", "").lower() == "chunked":
            parts = []
            while size := int(self.rfile.readline().split(b";")[0], 16):
                parts.append(self.rfile.read(size))
                self.rfile.readline()
            self.rfile.readline()
            return b"".join(parts)
        return self.rfile.read(int(self.headers.get("Content-Length") or 0))

    def answer(self, status, body=b"", headers=(), whole=True):
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body) + (0 if whole else 1000)))
        self.end_headers()
        self.wfile.write(body)
        if not whole:
            self.close_connection = True

    def respond(self):
        failure = self.server.failure(f"{self.command} {self.path}")
        if self.headers.get("Expect", "").lower() == "100-continue" and failure != "cut":
            self.send_response_only(100)
            self.end_headers()
        if failure == "silence":
            self.server.closing.wait(LIMIT_S)
            self.close_connection = True
            return
        if failure == "cut" and self.command != "GET":
            self.close_connection = True
            return
        body = self.body()
        if failure == "502":
            self.answer(502, b"<html>Bad Gateway</html>")
        elif self.path.startswith("/git/"):
            self.git(body, whole=failure != "cut")
        elif self.path != PACKAGE:
            self.answer(404, b"no such path")
        elif self.headers.get("JOB-TOKEN") != TOKEN:
            self.answer(401, b"no token")
        elif self.command == "PUT":
            if failure != "lies":
                self.server.stored = body
            self.answer(201, b'{"message":"201 Created"}')
        elif self.server.stored is None:
            self.answer(404, b'{"message":"404 Not Found"}')
        else:
            stored = self.server.stored
            self.answer(200, stored[: len(stored) // 2] if failure == "cut" else stored, whole=failure != "cut")

    do_GET = do_PUT = do_POST = respond

    def git(self, body, whole):
        path, _, query = self.path.removeprefix("/git").partition("?")
        environment = {
            **os.environ,
            "GIT_PROJECT_ROOT": str(self.server.repositories),
            "GIT_HTTP_EXPORT_ALL": "1",
            "REMOTE_USER": "job",
            "REQUEST_METHOD": self.command,
            "PATH_INFO": path,
            "QUERY_STRING": query,
            "CONTENT_TYPE": self.headers.get("Content-Type", ""),
            "CONTENT_LENGTH": str(len(body)),
            "HTTP_CONTENT_ENCODING": self.headers.get("Content-Encoding", ""),
            "GIT_PROTOCOL": self.headers.get("Git-Protocol", ""),
        }
        said = subprocess.run(["git", "http-backend"], input=body, env=environment, stdout=subprocess.PIPE).stdout
        head, _, content = said.partition(b"\r\n\r\n")
        headers = [line.decode().split(": ", 1) for line in head.split(b"\r\n") if line]
        status = next((int(value.split()[0]) for name, value in headers if name == "Status"), 200)
        content = content if whole else content[: len(content) // 2]
        self.answer(status, content, [pair for pair in headers if pair[0] != "Status"], whole)
