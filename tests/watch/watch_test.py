#!/usr/bin/env python3
# GPL-2.0-or-later. q3map2 -watch, from outside: its server, what saves do, and what is left when it ends.
"""usage: watch_test.py PROGRAM [unittest options]"""

import base64
import http.client
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

PROGRAM = ""
SECONDS = 120  # until something that hangs fails the test; builds with sanitizers are slow


def box(low, high):
    """A brush with axial sides."""
    (a, b, c), (d, e, f) = low, high
    planes = [((a, b, f), (a, e, f), (d, b, f)), ((a, b, c), (d, b, c), (a, e, c)),
              ((d, b, c), (d, b, f), (d, e, c)), ((a, b, c), (a, e, c), (a, b, f)),
              ((a, e, c), (d, e, c), (a, e, f)), ((a, b, c), (a, b, f), (d, b, c))]
    sides = ["".join("( %d %d %d ) " % point for point in plane) + "t/wall 0 0 0 0.5 0.5 0 0 0" for plane in planes]
    return "{\n" + "\n".join(sides) + "\n}\n"


def room(lamp="100 0 64", name="", hole=False):
    """Map source: a room with a light and a player."""
    half, high, thick = 192, 128, 16
    walls = [((-half, -half, -thick), (half, half, 0)), ((-half, -half, high), (half, half, high + thick)),
             ((-half - thick, -half, 0), (-half, half, high)),
             ((-half, -half - thick, 0), (half, -half, high)), ((-half, half, 0), (half, half + thick, high))]
    if not hole:
        walls.append(((half, -half, 0), (half + thick, half, high)))
    return ('{\n"classname" "worldspawn"\n"message" "' + name + '"\n' + "".join(box(*wall) for wall in walls) + "}\n"
            f'{{\n"classname" "light"\n"origin" "{lamp}"\n"light" "200"\n}}\n'
            '{\n"classname" "info_player_deathmatch"\n"origin" "0 0 32"\n}\n')


def is_running(process):
    """Whether a process has not ended. One that has may be listed until init has read its status."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


class Pages:
    """A page: a WebSocket that keeps the states it is told."""

    def __init__(self, watch):
        self.socket = socket.create_connection(("127.0.0.1", watch.port), timeout=SECONDS)
        status, self.rest = handshake(self.socket, watch, f"http://127.0.0.1:{watch.port}")
        assert status == 101, status
        self.state = {}

    def read(self, count):
        while len(self.rest) < count:
            got = self.socket.recv(65536)
            if not got:
                raise EOFError
            self.rest += got
        data, self.rest = self.rest[:count], self.rest[count:]
        return data

    def next(self):
        """The next state."""
        while True:
            first, size = self.read(2)
            if size == 126:
                size, = struct.unpack(">H", self.read(2))
            elif size == 127:
                size, = struct.unpack(">Q", self.read(8))
            data = self.read(size)
            if first & 15 == 1:
                self.state = json.loads(data)
                return self.state
            if first & 15 == 8:
                raise EOFError

    def until(self, condition):
        end = time.monotonic() + SECONDS
        while not (self.state and condition(self.state)):
            if time.monotonic() > end:
                raise AssertionError(f"still {self.state}")
            self.next()
        return self.state

    def close(self):
        self.socket.close()


def handshake(connection, watch, origin, path=None, host=None):
    lines = [f"GET {path or watch.path + 'socket'} HTTP/1.1", f"Host: {host or f'127.0.0.1:{watch.port}'}",
             "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
             f"Sec-WebSocket-Key: {base64.b64encode(bytes(16)).decode()}"]
    if origin:
        lines.append(f"Origin: {origin}")
    connection.sendall("\r\n".join([*lines, "", ""]).encode())
    head = b""
    while b"\r\n\r\n" not in head:
        got = connection.recv(4096)
        if not got:
            break
        head += got
    text, _, rest = head.partition(b"\r\n\r\n")
    return int(text.split()[1]), rest


class Running:
    """A game folder, and -watch on the map in it."""

    def __init__(self, test, source=room(), options=(), word="maps/room.map"):
        temporary = tempfile.TemporaryDirectory()
        test.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)
        self.game = self.root / "baseq3"
        (self.game / "maps").mkdir(parents=True)
        (self.game / "scripts").mkdir()
        (self.game / "scripts/t.shader").write_text("textures/t/wall\n{\n\t{\n\t\tmap $lightmap\n\t}\n}\n")
        self.map = self.game / "maps/room.map"
        if source is not None:
            self.map.write_text(source)
        self.output = []
        self.start(test, options, word)

    def line(self, *words):
        return [PROGRAM, "-fs_basepath", str(self.root), "-fs_nohomepath", *words]

    def start(self, test, options=(), word="maps/room.map"):
        self.process = subprocess.Popen(self.line("-watch", *options, word), cwd=self.game, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True)
        test.addCleanup(self.kill)
        self.reader = threading.Thread(target=lambda: self.output.extend(self.process.stdout))
        self.reader.start()
        self.address = self.wait_for_line(r"The page: (http://127\.0\.0\.1:(\d+)(/[0-9a-f]{32}/))\n")
        self.port, self.path = int(self.address[2]), self.address[3]

    def wait_for_line(self, pattern):
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            if found := re.search(pattern, "".join(self.output)):
                return found
            if self.process.poll() is not None:
                time.sleep(0.2)
                if found := re.search(pattern, "".join(self.output)):
                    return found
                break
            time.sleep(0.02)
        raise AssertionError(f"no {pattern} in\n{''.join(self.output)}")

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()

    def get(self, path, method="GET", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=SECONDS)
        try:
            connection.putrequest(method, path, skip_host="Host" in headers)
            for name, value in headers.items():
                connection.putheader(name, value)
            connection.endheaders()
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def page(self, test):
        page = Pages(self)
        test.addCleanup(page.close)
        return page

    def save(self, text):
        """As editors do: a new file takes the place of the old one."""
        new = self.map.with_suffix(".new")
        new.write_text(text)
        new.rename(self.map)

    def message(self):
        """The key of the world in the .bsp on disk."""
        data = (self.game / "maps/room.bsp").read_bytes()
        offset, length = struct.unpack_from("<2i", data, 8)
        return re.search(rb'"message" "([^"]*)"', data[offset:offset + length])[1].decode()

    def children(self):
        tasks = Path(f"/proc/{self.process.pid}/task")
        return [child for task in tasks.iterdir() for child in (task / "children").read_text().split()]

    def end(self, test, number=signal.SIGINT):
        children = self.children()
        self.process.send_signal(number)
        test.assertEqual(self.process.wait(SECONDS), 0, "".join(self.output))
        for child in children:
            test.assertFalse(is_running(child), "a stage is left")
        left = {path.name for path in self.map.parent.iterdir()}
        test.assertLessEqual(left, {f"room.{end}" for end in ("map", "bsp", "srf", "prt", "lin")})



class Server(unittest.TestCase):
    def setUp(self):
        self.watch = Running(self)
        self.pages = self.watch.page(self)
        self.pages.until(lambda state: state["version"] > 0)

    def test_what_is_served(self):
        path = self.watch.path
        status, page = self.watch.get(path)
        self.assertEqual(status, 200)
        self.assertIn(b'<div id="watch" data-map="maps/room.bsp" hidden></div>', page)
        self.assertIn(f"connect-src http://127.0.0.1:{self.watch.port} ws://127.0.0.1:".encode(), page)
        self.assertEqual(self.watch.get(path + "map.bsp?1")[1][:4], b"IBSP")
        self.assertEqual(self.watch.get(path + "resources.pk3")[1][:2], b"PK")
        lights = json.loads(self.watch.get(path + "lights.json")[1])
        self.assertEqual(lights, [{"classname": "light", "origin": "100 0 64", "light": "200"}])
        self.assertEqual(self.watch.get(path, "HEAD"), (200, b""))

    def test_the_token_is_needed(self):
        path = self.watch.path
        wrong = path[:-2] + ("0" if path[-2] != "0" else "1") + "/"
        for bad in ("/", "/map.bsp", wrong, wrong + "map.bsp", path[:-1], path.upper() + "x", "//" + path[1:]):
            self.assertEqual(self.watch.get(bad)[0], 403, bad)

    def test_only_this_host(self):
        port = self.watch.port
        self.assertEqual(self.watch.get(self.watch.path, Host=f"localhost:{port}")[0], 200)
        for host in (f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{port + 1}", f"127.0.0.1:{port}.evil.example", ""):
            self.assertIn(self.watch.get(self.watch.path, Host=host)[0], (400, 403), host)

    def test_only_its_own_pages(self):
        port = self.watch.port
        self.assertEqual(self.watch.get(self.watch.path, Origin=f"http://localhost:{port}")[0], 200)
        for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port + 1}"):
            self.assertEqual(self.watch.get(self.watch.path + "map.bsp", Origin=origin)[0], 403, origin)
            self.assertEqual(self.socket_status(origin), 403, origin)
        self.assertEqual(self.socket_status(""), 403)
        self.assertEqual(self.socket_status(f"http://127.0.0.1:{port}"), 101)
        self.assertEqual(self.socket_status(f"http://127.0.0.1:{port}", path="/socket"), 403)
        self.assertEqual(self.socket_status(f"http://127.0.0.1:{port}", host="evil.example"), 403)

    def socket_status(self, origin, **others):
        with socket.create_connection(("127.0.0.1", self.watch.port), timeout=SECONDS) as connection:
            return handshake(connection, self.watch, origin, **others)[0]

    def test_nothing_else_is_served(self):
        path = self.watch.path
        for name in ("../../../../../../etc/passwd", "..%2f..%2fetc%2fpasswd", "/etc/passwd", "room.map", "room.bsp",
                     "maps/room.bsp", "map.bsp/", "%2e%2e/room.map", "map.bsp%00", "map.bsp\\..\\x"):
            status, body = self.watch.get(path + name)
            self.assertIn(status, (400, 403, 404), name)
            self.assertNotIn(b"root:", body)
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "PROPFIND"):
            self.assertEqual(self.watch.get(path + "map.bsp", method)[0], 405, method)

    def test_it_listens_on_the_loopback_alone(self):
        listening = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
        port = f"{self.watch.port:04X}"
        local = [words[1] for words in listening if words[3] == "0A" and words[1].endswith(f":{port}")]
        self.assertEqual(local, [f"0100007F:{port}"])
        six = Path("/proc/net/tcp6")
        lines = six.read_text().splitlines()[1:] if six.exists() else []
        self.assertFalse([line for line in lines if line.split()[1].endswith(f":{port}") and line.split()[3] == "0A"])


class Saves(unittest.TestCase):
    def test_ctrl_c_leaves_nothing(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            watch = Running(self, options=("-lightoptions", "-samples 8 -bounce 20"))
            watch.page(self).until(lambda state: state["stages"][-1]["name"] == "light")
            watch.end(self, number)

    def test_links_to_old_files_are_removed(self):
        """A stage that is stopped while it replaces several files may leave a hard link to an old one, with its time."""
        watch = Running(self, options=("-lightoptions", "-samples 16 -samplesize 1 -bounce 20"))
        watch.page(self).until(lambda state: state["stages"][-1]["name"] == "light"
                               and state["stages"][-1]["pass"] == "final" and state["running"])
        portals = watch.game / "maps/room.prt"
        os.utime(portals, (1, 1))
        os.link(portals, portals.with_name("room.prt.3ZK4MC.tmp"))
        watch.end(self)

    def test_a_stage_does_not_outlive_a_killed_watch(self):
        watch = Running(self, options=("-draftoptions", "-samples 16 -samplesize 1"))
        watch.page(self).until(lambda state: state["stages"][-1]["name"] == "light")
        children = watch.children()
        self.assertEqual(len(children), 1)
        watch.process.kill()
        watch.process.wait()
        end = time.monotonic() + SECONDS
        while Path(f"/proc/{children[0]}").exists() and time.monotonic() < end:
            if Path(f"/proc/{children[0]}/stat").read_text().split(")")[1].split()[0] == "Z":
                break
            time.sleep(0.02)
        else:
            self.assertFalse(Path(f"/proc/{children[0]}").exists())

    def test_the_last_save_counts_during_builds(self):
        watch = Running(self, room(name="first"), options=("-draftoptions", "-samples 8 -samplesize 2"))
        page = watch.page(self)
        page.until(lambda state: state["stages"][-1]["name"] == "light")
        watch.save(room(name="second"))
        page.until(lambda state: state["save"] == 2)
        page.until(lambda state: state["stages"][-1]["name"] == "light")
        watch.save(room(name="third"))
        page.until(lambda state: state["save"] == 3 and state["version"] > 0 and not state["running"]
                   and watch.message() == "third")
        watch.end(self)

    def test_many_saves(self):
        watch = Running(self)
        page = watch.page(self)
        for number in range(40):
            if number % 2:
                watch.save(room(name=str(number)))
            else:
                watch.map.write_text(room(name=str(number)))
            time.sleep(0.03 * (number % 4))
        page.until(lambda state: state["pass"] == "final" and not state["running"] and watch.message() == "39")
        self.assertEqual([stage["state"] for stage in page.state["stages"]], ["done"] * 5)
        watch.end(self)

    def test_a_map_that_does_not_parse(self):
        watch = Running(self, room(name="good"))
        page = watch.page(self)
        page.until(lambda state: state["version"] > 0)
        watch.save(room(name="bad") + "{\n\"classname\"\n")
        # A stage of the build before may end first, since the source has changed while it ran.
        state = page.until(lambda state: state["save"] == 2 and len(state["stages"]) == 1
                           and state["stages"][-1]["state"] == "failed")
        self.assertEqual([stage["name"] for stage in state["stages"]], ["bsp"])
        errors = [message["text"] for message in state["messages"] if message["level"] == "error"]
        self.assertEqual(len(errors), 1, errors)
        self.assertIn("room.map:", errors[0])
        version = state["version"]
        self.assertEqual(watch.message(), "good")
        self.assertEqual(watch.get(watch.path + "map.bsp")[0], 200, "the old picture stays")
        watch.save(room(name="better"))
        state = page.until(lambda state: state["version"] > version)
        self.assertEqual(state["messages"], [])
        self.assertEqual(watch.message(), "better")
        watch.end(self)

    def test_a_leak(self):
        watch = Running(self, room(hole=True))
        page = watch.page(self)
        state = page.until(lambda state: state["version"] > 0)
        self.assertEqual([stage["name"] for stage in state["stages"]][:2], ["bsp", "light"], "no portals, no vis")
        points = [[float(word) for word in line.split()]
                  for line in (watch.game / "maps/room.lin").read_text().splitlines()]
        self.assertEqual(state["leak"], points)
        errors = {message["text"]: message.get("at") for message in state["messages"]}
        self.assertEqual(errors["MAP LEAKED"], points[-1])
        watch.save(room())
        # The build before may still have been running. It had no vis.
        state = page.until(lambda state: state["save"] == 2 and "vis" in [stage["name"] for stage in state["stages"]])
        self.assertEqual(state["leak"], [])
        watch.end(self)

    def test_messages_name_places(self):
        # A wall with a side twice, which -v tells about: brush 6 of the world.
        odd = box((0, 0, 0), (32, 32, 64)).replace("{\n", "{\n( 0 0 64 ) ( 0 32 64 ) ( 32 0 64 ) t/wall 0 0 0 1 1 0 0 0\n")
        watch = Running(self, room().replace("}\n}\n", "}\n" + odd + "}\n", 1), options=("-v",))
        state = watch.page(self).until(lambda state: state["version"] > 0)
        places = [message["at"] for message in state["messages"] if message["text"].startswith("Entity 0, Brush 6: ")]
        self.assertEqual(places, [[16, 16, 32]], state["messages"])
        watch.end(self)

    def test_the_source_goes_and_comes_back(self):
        watch = Running(self, room(name="one"), word="maps/room")
        page = watch.page(self)
        page.until(lambda state: state["version"] > 0)
        watch.map.unlink()
        page.until(lambda state: state["gone"])
        watch.map.write_text(room(name="two"))
        page.until(lambda state: not state["gone"] and state["save"] == 2 and not state["running"])
        self.assertEqual(watch.message(), "two")
        watch.end(self)

    def test_one_watch_for_a_map(self):
        watch = Running(self)
        lock = watch.game / "maps/room.watch"
        self.assertEqual(lock.stat().st_mode & 0o077, 0, "the address is secret")
        link = watch.game / "maps/link.map"
        link.symlink_to("room.map")
        for word in ("maps/room.map", "maps/link.map"):
            second = subprocess.run(watch.line("-watch", word), cwd=watch.game, capture_output=True, text=True,
                                    timeout=SECONDS, check=False)
            self.assertEqual(second.returncode, 1, second.stdout)
            self.assertIn(watch.path, second.stdout)
        link.unlink()
        watch.kill()
        self.assertTrue(lock.exists())
        for unfinished in lock.parent.glob("room.*.tmp"):  # the stage that ran was killed too
            unfinished.unlink()
        watch.output.clear()
        watch.start(self)
        watch.end(self)

    def test_options(self):
        watch = Running(self, options=("-bspoptions", "-meta -samplesize 4", "-visoptions", "-fast", "-lightoptions",
                                       "-faster -gamma 1.5", "-draftoptions", "-faster", "-threads", "1"))
        watch.page(self).until(lambda state: state["pass"] == "final" and not state["running"])
        data = (watch.game / "maps/room.bsp").read_bytes()
        for words in (b"-bsp -meta -samplesize 4", b"-vis -fast -saveprt", b"-light -faster -gamma 1.5"):
            self.assertIn(words, data)
        watch.end(self)
        for bad in (("-bspoptions", "-bspfile x.bsp"), ("-lightoptions", "-explain 0 0 0"), ("-port", "70000")):
            run = subprocess.run(watch.line("-watch", *bad, "maps/room.map"), cwd=watch.game, capture_output=True,
                                 text=True, timeout=SECONDS, check=False)
            self.assertEqual(run.returncode, 1, run.stdout)
            self.assertIn(bad[0], run.stdout)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
