"""Object storage for rigs: moto's S3, and a proxy before it that refuses, holds, loses or forgets what it is told to."""

import contextlib
import http.client
import http.server
import os
import socket
import sys
import threading
import time
import urllib.parse
import xml.etree.ElementTree as tree

from children import popen


class Handler(http.server.BaseHTTPRequestHandler):
    """Passes a request on, as the server's switches say."""

    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def passed(self):
        store = self.server.store
        body = self.rfile.read(int(self.headers.get("content-length", 0)))
        is_write = self.command == "PUT"
        if is_write:
            with store.counting:
                store.writing += 1
        if store.refusing:
            status, headers, answer = 503, [], b"<Error><Code>SlowDown</Code></Error>"
        elif is_write and store.forgetting:
            # Confirmed, and never stored.
            status, headers, answer = 200, [("etag", '"0"')], b""
        else:
            if is_write:
                store.free.wait()
            server = http.client.HTTPConnection("127.0.0.1", store.inner, timeout=60)
            # The signature is of the headers as the client has sent them.
            server.putrequest(self.command, self.path, skip_host=True, skip_accept_encoding=True)
            for name, value in self.headers.items():
                server.putheader(name, value)
            server.endheaders(body)
            reply = server.getresponse()
            answer = reply.read()
            status, headers = reply.status, reply.getheaders()
            server.close()
            if store.endless and "list-type" in self.path:
                # Every page leads to itself.
                answer = answer.replace(b"<IsTruncated>false", b"<NextContinuationToken>on</NextContinuationToken><IsTruncated>true")
        with store.counting:
            store.log.append((self.command, self.path, status))
            if is_write:
                store.writing -= 1
            is_lost = is_write and store.losing > 0
            store.losing -= is_lost
        if is_lost:
            self.close_connection = True
            self.connection.close()
            return
        self.send_response(status)
        for name, value in headers:
            if name.lower() not in ("content-length", "connection", "date", "server", "transfer-encoding"):
                self.send_header(name, value)
        length = dict((name.lower(), value) for name, value in headers).get("content-length", len(answer))
        self.send_header("content-length", length if self.command == "HEAD" else len(answer))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(answer)

    do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = passed


class Proxy(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, *_):
        """A client that was killed."""


class ObjectStore:
    """A server on this computer with the bucket `rig`; `environment` is what its clients need."""

    def __init__(self, log):
        with contextlib.closing(socket.create_server(("127.0.0.1", 0))) as free:
            self.inner = free.getsockname()[1]
        self.moto = popen(
            [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(self.inner)],
            stdout=log, stderr=log)
        self.refusing, self.losing, self.log = False, 0, []
        self.forgetting = self.endless = False
        self.counting, self.writing = threading.Lock(), 0
        self.free = threading.Event()
        self.free.set()
        self.proxy = Proxy(("127.0.0.1", 0), Handler)
        self.proxy.store = self
        threading.Thread(target=self.proxy.serve_forever, daemon=True).start()
        # Minutes: only what hangs takes as long.
        for _ in range(3000):
            if self.moto.poll() is not None:
                raise SystemExit("FAIL moto ended")
            try:
                self.asked("PUT", "/rig")
                break
            except OSError:
                time.sleep(0.1)
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.lower().endswith("_proxy")},
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{self.proxy.server_address[1]}", "AWS_ALLOW_HTTP": "true",
            "AWS_REGION": "us-east-1", "AWS_ACCESS_KEY_ID": "rig", "AWS_SECRET_ACCESS_KEY": "secret"}

    def asked(self, method, path, body=b""):
        """Asks moto itself; the status and the body of the answer."""
        server = http.client.HTTPConnection("127.0.0.1", self.inner, timeout=60)
        # Any signature will do; without one an object is another's.
        signed = "AWS4-HMAC-SHA256 Credential=rig/20260101/us-east-1/s3/aws4_request, SignedHeaders=host, Signature=0"
        server.request(method, path, body, {"authorization": signed})
        reply = server.getresponse()
        return reply.status, reply.read()

    def objects(self, prefix):
        """Names and lengths of the objects that begin so."""
        found, token = {}, ""
        while True:
            _, text = self.asked("GET", f"/rig?list-type=2&prefix={urllib.parse.quote(prefix)}{token}")
            root = tree.fromstring(text)
            space = root.tag.removesuffix("ListBucketResult")
            for one in root.iter(f"{space}Contents"):
                found[one.find(f"{space}Key").text] = int(one.find(f"{space}Size").text)
            following = root.find(f"{space}NextContinuationToken")
            if following is None:
                return found
            token = "&continuation-token=" + urllib.parse.quote(following.text, safe="")

    def end(self):
        self.proxy.shutdown()
        self.moto.kill()
        self.moto.wait()
