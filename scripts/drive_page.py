"""Drives the studio's page in headless Chromium, by the DevTools protocol over pipes; for scripts/test-web.sh.

usage: drive_page.py URL PICTURE.png [CHROMIUM FLAGS...]

Waits until the page says that its script is done, takes a picture, prints what the page told, and fails if it told an error or the
picture is of one colour.
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

        usual = ["--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--window-size=1280,800",
                 "--remote-debugging-pipe", f"--user-data-dir={self.folder.name}"]
        self.process = subprocess.Popen([os.environ.get("CHROMIUM", "chromium"), *usual, *flags, "about:blank"], close_fds=False,
                                        preexec_fn=pipes, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(theirs_in)
        os.close(theirs_out)
        self.answers, self.commands = os.fdopen(ours_in, "rb"), os.fdopen(ours_out, "wb")
        self.rest, self.number, self.told = b"", 0, []

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
        if event.get("method") == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            text = " ".join(str(a.get("value", a.get("description"))) for a in params["args"])
            self.told.append((params["type"], text))
        elif event.get("method") == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.told.append(("error", details.get("exception", {}).get("description", details["text"])))

    def close(self):
        self.process.terminate()
        self.process.wait(20)


def colours(png):
    """How many different colours a PNG of 8-bit RGB(A) has; rows are taken as they are filtered, which is enough to tell one from many."""
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

        browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=os.path.dirname(os.path.abspath(picture)))

        def value(expression):
            found = browser.call("Runtime.evaluate", session, expression=expression, returnByValue=True, awaitPromise=True)
            return found["result"].get("value")

        begun = time.time()
        browser.call("Page.navigate", session, url=url)
        state = "loading"
        while time.time() - begun < LIMIT_S and state not in ("done", "failed"):
            time.sleep(0.5)
            state = value("document.body && document.body.dataset.state") or "loading"
        frames = value("""new Promise((done) => { const begun = performance.now(); let n = 0;
            const step = () => { n++; performance.now() - begun > 3000 ? done((performance.now() - begun) / n) : requestAnimationFrame(step); };
            requestAnimationFrame(step); })""") if state == "done" else None
        png = base64.b64decode(browser.call("Page.captureScreenshot", session, format="png")["data"])
        with open(picture, "wb") as file:
            file.write(png)
        graphics, load_ms = value("document.body.dataset.graphics"), value("document.body.dataset.loadMs")
        print(f"{url}\n  {state} after {time.time() - begun:.1f} s; {graphics}; running after {load_ms} ms")
        if frames:
            print(f"  {frames:.1f} ms between frames")
        for kind, text in browser.told:
            print(f"  {kind}: {text[:1200]}")
        many = colours(png)
        if state != "done":
            sys.exit(f"error: the page is {state} instead of done; see {picture}")
        if any(kind == "error" for kind, _ in browser.told):
            sys.exit("error: the page told an error")
        if many < 50:
            sys.exit(f"error: the page is blank; see {picture}")
    finally:
        browser.close()


main()
