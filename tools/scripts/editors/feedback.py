# GPL-2.0-or-later. The listening end of -connect, as strict as the editors are.
"""Editor listens, takes one connection and reads its XML."""

import socket
from dataclasses import dataclass, field
from xml.parsers import expat

MAX_PAYLOAD = 1020  # bytes of a message after its length
WHOLE = ("point", "brush", "winding", "select")  # editors use their text as it arrives: it must come in one message


class FeedbackError(Exception):
    """A stream that an editor would misread."""


@dataclass
class Feedback:
    """What arrived: (level, text) of messages, (text, (entity, brush)) of selects, points of leak trails; `events` has
    the order of all of them."""
    messages: list = field(default_factory=list)
    selects: list = field(default_factory=list)
    trails: list = field(default_factory=list)
    events: list = field(default_factory=list)
    failed: bool = False  # an error arrived

    def text(self):
        return "".join(text for _, text in self.messages)


class FeedbackReader:
    """Push parser of the stream; `show(level, text)` is called for text of messages as it arrives."""

    def __init__(self, show=lambda level, text: None):
        self.feedback, self.show = Feedback(), show
        self.stack, self.parts, self.level, self.said = [], [], 1, ""
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.text
        self.parser.ordered_attributes = True
        self.payloads = 0

    def feed(self, payload):
        self.payloads += 1
        self.parser.Parse(payload, False)

    def start(self, name, attributes):
        if not self.stack and (name, attributes[:2]) != ("q3map_feedback", ["version", "1"]):
            raise FeedbackError(f"root <{name} {attributes}>")
        if len(self.stack) == 1:
            if attributes[:1] != ["level"]:
                raise FeedbackError(f"<{name}> whose first attribute is no level")
            self.level, self.said = int(attributes[1]), ""
        if name == "polyline":
            self.feedback.trails.append([])
        self.stack.append(name)
        self.parts = []

    def text(self, data):
        name = self.stack[-1]
        if name == "message":
            self.show(self.level, data)
            self.feedback.messages.append((self.level, data))
            self.said += data
        elif name == "select":
            self.said += data
        self.parts.append((self.payloads, data))

    def end(self, name):
        text = "".join(part for _, part in self.parts)
        if name in WHOLE and len({payload for payload, _ in self.parts}) > 1:
            raise FeedbackError(f"<{name}> comes in several messages: {text}")
        if name == "point":
            point = tuple(float(word) for word in text.split())
            if len(point) != 3:
                raise FeedbackError(f"a point {text}")
            self.feedback.trails[-1].append(point)
        elif name == "polyline":
            self.feedback.events.append("trail")
        elif name == "brush":
            entity, brush = (int(word) for word in text.split())
            self.feedback.selects.append((self.said, (entity, brush)))
            self.feedback.events.append("select")
            self.show(2, self.said + "\n")
        elif name == "message":
            self.feedback.events.append("message")
            self.feedback.failed = self.feedback.failed or self.level == 3
        self.stack.pop()
        self.parts = []


def receive_payload(connection):
    """None at the end. A message that does not arrive in one piece ends an editor's stream: an error here."""
    head = connection.recv(4, socket.MSG_PEEK | socket.MSG_WAITALL)
    if not head:
        return None
    length = int.from_bytes(head, "little")
    if len(head) < 4 or not 1 <= length <= MAX_PAYLOAD:
        raise FeedbackError(f"a message of {length} bytes")
    message = connection.recv(4 + length, socket.MSG_DONTWAIT)
    if len(message) != 4 + length:
        raise FeedbackError("a message in parts")
    if b"\0" in message[4:]:
        raise FeedbackError("a NUL byte")
    return message[4:]


class Editor:
    """Listens on a port; 0 chooses a free one."""

    def __init__(self, port=0):
        self.socket = socket.create_server(("127.0.0.1", port))
        self.address = "127.0.0.1:%d" % self.socket.getsockname()[1]

    def close(self):
        self.socket.close()

    def read(self, seconds, show=lambda level, text: None, stops_on_error=True):
        """The feedback of one program, or None if nothing connects in that time."""
        self.socket.settimeout(seconds)
        try:
            connection, _ = self.socket.accept()
        except TimeoutError:
            return None
        reader = FeedbackReader(show)
        with connection:
            connection.settimeout(None)
            while (payload := receive_payload(connection)) is not None:
                reader.feed(payload)
                if reader.feedback.failed and stops_on_error:
                    break
        return reader.feedback
