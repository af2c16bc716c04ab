"""Drives the studio's page in headless Chromium, by the DevTools protocol over pipes.

usage: drive_page.py URL PICTURE.png [CHROMIUM FLAGS...]

For scripts/test-web.sh. Waits until the page's script is done, writes a picture, and prints the
page's errors and warnings. Fails if there was an error or the picture is of one colour.
"""

import base64
import json
import os
import subprocess
import sys
import tempfile
import time
import zlib

LIMIT_S = float(os.environ.get("LIMIT_S", 600))

# Mean time between the frames of three seconds (ms).
FRAME_MS = """new Promise((done) => {
  const begun = performance.now();
  let n = 0;
  const step = () => {
    n++;
    const passed = performance.now() - begun;
    if (passed > 3000) done(passed / n);
    else requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})"""


class Browser:
    def __init__(self, flags):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        ours_in, theirs_out = os.pipe()
        theirs_in, ours_out = os.pipe()

        def pipes():
            # Chromium reads commands from 3 and answers on 4.
            a, b = os.dup(theirs_in), os.dup(theirs_out)
            os.dup2(a, 3)
            os.dup2(b, 4)

        usual = [
            "--headless=new",
            "--no-sandbox",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--hide-scrollbars",
            "--window-size=1280,800",
            "--remote-debugging-pipe",
            f"--user-data-dir={self.folder.name}",
        ]
        self.process = subprocess.Popen(
            [os.environ.get("CHROMIUM", "chromium"), *usual, *flags, "about:blank"],
            close_fds=False,
            preexec_fn=pipes,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(theirs_in)
        os.close(theirs_out)
        self.answers, self.commands = os.fdopen(ours_in, "rb"), os.fdopen(ours_out, "wb")
        self.rest, self.number, self.messages = b"", 0, []

    def call(self, method, session=None, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        self.commands.write(json.dumps(message).encode() + b"\0")
        self.commands.flush()
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    sys.exit(f"error: {method}: {answer['error']['message']}")
                return answer["result"]
            self.hear(answer)

    def read(self):
        while b"\0" not in self.rest:
            part = os.read(self.answers.fileno(), 1 << 20)
            if not part:
                sys.exit("error: Chromium ended; run it by hand to see why")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def hear(self, event):
        params = event.get("params", {})
        method = event.get("method")
        if method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            text = " ".join(str(a.get("value", a.get("description"))) for a in params["args"])
            self.messages.append((params["type"], text))
        elif method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            text = details.get("exception", {}).get("description", details["text"])
            self.messages.append(("error", text))

    def close(self):
        self.process.terminate()
        self.process.wait(20)


def colours(png):
    """Number of different colours in a PNG of 8-bit RGB(A), estimated from its filtered rows."""
    at, data = 8, b""
    while at < len(png):
        size = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IDAT":
            data += png[at + 8:at + 8 + size]
        at += 12 + size
    data = zlib.decompress(data)
    return len({data[i:i + 4] for i in range(0, len(data) - 4, 97)})


def main():
    url, picture, *flags = sys.argv[1:]
    browser = Browser(flags)
    try:
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        browser.call("Runtime.enable", session)
        browser.call("Page.enable", session)
        size = {"width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": False}
        browser.call("Emulation.setDeviceMetricsOverride", session, **size)

        downloads = os.path.dirname(os.path.abspath(picture))
        browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=downloads)

        def value(expression):
            found = browser.call(
                "Runtime.evaluate",
                session,
                expression=expression,
                returnByValue=True,
                awaitPromise=True,
            )
            return found["result"].get("value")

        begun = time.time()
        browser.call("Page.navigate", session, url=url)
        state = "loading"
        while time.time() - begun < LIMIT_S and state not in ("done", "failed"):
            time.sleep(0.5)
            state = value("document.body && document.body.dataset.state") or "loading"
        frame_ms = value(FRAME_MS) if state == "done" else None
        shot = browser.call("Page.captureScreenshot", session, format="png")
        png = base64.b64decode(shot["data"])
        with open(picture, "wb") as file:
            file.write(png)
        graphics = value("document.body.dataset.graphics")
        load_ms = value("document.body.dataset.loadMs")
        seconds = time.time() - begun
        print(f"{url}\n  {state} after {seconds:.1f} s; {graphics}; running after {load_ms} ms")
        if frame_ms:
            print(f"  {frame_ms:.1f} ms between frames")
        for kind, text in browser.messages:
            print(f"  {kind}: {text[:1200]}")
        many = colours(png)
        if state != "done":
            sys.exit(f"error: the page is {state} instead of done; see {picture}")
        if any(kind == "error" for kind, _ in browser.messages):
            sys.exit("error: the page reported an error")
        if many < 50:
            sys.exit(f"error: the page is blank; see {picture}")
    finally:
        browser.close()


main()
