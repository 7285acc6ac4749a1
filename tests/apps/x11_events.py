"""What xdotool cannot do without a window manager: drop files on a window, minimise it, and read its pixels."""

import ctypes
import time
from ctypes import POINTER, Structure, Union, byref, c_char_p, c_int, c_long, c_uint, c_ulong, c_void_p, string_at

import numpy as np

SELECTION_REQUEST, SELECTION_NOTIFY, CLIENT_MESSAGE = 30, 31, 33
NORMAL, ICONIC = 1, 3  # Values of WM_STATE.
REPLACE = 0  # Mode of XChangeProperty.
ZPIXMAP = 2  # Format of XGetImage.
EVENT_HEAD = [("type", c_int), ("serial", c_ulong), ("is_sent", c_int), ("display", c_void_p)]


class ClientMessage(Structure):
    _fields_ = [*EVENT_HEAD, ("window", c_ulong), ("kind", c_ulong), ("bits", c_int), ("data", c_long * 5)]


class SelectionRequest(Structure):
    _fields_ = [*EVENT_HEAD, ("owner", c_ulong), ("requestor", c_ulong), ("selection", c_ulong), ("target", c_ulong),
                ("property", c_ulong), ("time", c_ulong)]


class SelectionNotify(Structure):
    _fields_ = [*EVENT_HEAD, ("requestor", c_ulong), ("selection", c_ulong), ("target", c_ulong), ("property", c_ulong),
                ("time", c_ulong)]


class Event(Union):
    _fields_ = [("type", c_int), ("client", ClientMessage), ("request", SelectionRequest), ("notify", SelectionNotify),
                ("room", c_long * 24)]


class Image(Structure):
    """The head of an XImage."""
    _fields_ = [(name, c_int) for name in ("width", "height", "left", "format")] + [
        ("data", c_void_p), *((name, c_int) for name in ("order", "unit", "bits", "pad", "depth", "row_bytes"))]


class Display:
    """A connection to an X server, which acts as a file manager and as a window manager."""

    def __init__(self, name):
        self.x = ctypes.CDLL("libX11.so.6")
        self.x.XOpenDisplay.restype = c_void_p
        self.x.XOpenDisplay.argtypes = [c_char_p]
        self.handle = c_void_p(self.x.XOpenDisplay(name.encode()))
        if not self.handle:
            raise ConnectionError(f"there is no display {name}")
        for function, result, arguments in (
                ("XDefaultRootWindow", c_ulong, []),
                ("XInternAtom", c_ulong, [c_char_p, c_int]),
                ("XCreateSimpleWindow", c_ulong, [c_ulong, c_int, c_int, c_uint, c_uint, c_uint, c_ulong, c_ulong]),
                ("XSetSelectionOwner", c_int, [c_ulong, c_ulong, c_ulong]),
                ("XSendEvent", c_int, [c_ulong, c_int, c_long, POINTER(Event)]),
                ("XChangeProperty", c_int, [c_ulong, c_ulong, c_ulong, c_int, c_int, c_char_p, c_int]),
                ("XPending", c_int, []), ("XNextEvent", c_int, [POINTER(Event)]), ("XSync", c_int, [c_int]),
                ("XMapWindow", c_int, [c_ulong]), ("XUnmapWindow", c_int, [c_ulong]),
                ("XGetImage", POINTER(Image), [c_ulong, c_int, c_int, c_uint, c_uint, c_ulong, c_int])):
            found = getattr(self.x, function)
            found.restype, found.argtypes = result, [c_void_p, *arguments]

    def call(self, function, *arguments):
        return getattr(self.x, function)(self.handle, *arguments)

    def atom(self, name):
        return self.call("XInternAtom", name.encode(), 0)

    def close(self):
        self.x.XCloseDisplay(self.handle)

    def pixels(self, window, width, height):
        """Returns what a window of this size shows, panels too, as (height, width, 3)."""
        image = self.call("XGetImage", window, 0, 0, width, height, 0xffffffff, ZPIXMAP).contents
        shown = np.frombuffer(string_at(image.data, image.row_bytes * height), np.uint8)
        return shown.reshape(height, -1, 4)[:, :width, 2::-1]  # Blue comes first.

    def minimise(self, window):
        """Does what a window manager does when it minimises a window."""
        self.set_state(window, ICONIC)
        self.call("XUnmapWindow", window)
        self.call("XSync", 0)

    def restore(self, window):
        self.call("XMapWindow", window)
        self.set_state(window, NORMAL)
        self.call("XSync", 0)

    def set_state(self, window, state):
        kind = self.atom("WM_STATE")
        self.call("XChangeProperty", window, kind, kind, 32, REPLACE, bytes((c_long * 2)(state, 0)), 2)

    def set_scale(self, scale):
        """Sets the scale of the screen, for programs that start from now on."""
        root, text = self.call("XDefaultRootWindow"), f"Xft.dpi:\t{96 * scale}\n".encode()
        self.call("XChangeProperty", root, self.atom("RESOURCE_MANAGER"), self.atom("STRING"), 8, REPLACE, text, len(text))
        self.call("XSync", 0)

    def drop(self, window, paths, patience):
        """Drops files on a window, by version 5 of the protocol XDND. Returns whether it took them."""
        source = self.call("XCreateSimpleWindow", self.call("XDefaultRootWindow"), 0, 0, 1, 1, 0, 0, 0)
        self.call("XSetSelectionOwner", self.atom("XdndSelection"), source, 0)
        uris = self.atom("text/uri-list")
        self.send(window, "XdndEnter", source, 5 << 24, uris)
        self.send(window, "XdndPosition", source, 0, 0, 0, self.atom("XdndActionCopy"))
        self.send(window, "XdndDrop", source)
        text = "".join(f"{path.as_uri()}\r\n" for path in paths).encode()
        end = time.monotonic() + patience
        while time.monotonic() < end:
            if not self.call("XPending"):
                time.sleep(0.01)
                continue
            event = Event()
            self.call("XNextEvent", byref(event))
            if event.type == SELECTION_REQUEST:
                self.hand_over(event.request, text)
            if event.type == CLIENT_MESSAGE and event.client.kind == self.atom("XdndFinished"):
                return event.client.data[1] != 0
        raise AssertionError("the window did not answer")

    def send(self, window, kind, *data):
        event = Event()
        event.client = ClientMessage(type=CLIENT_MESSAGE, window=window, kind=self.atom(kind), bits=32,
                                     data=(c_long * 5)(*data))
        self.call("XSendEvent", window, 0, 0, byref(event))
        self.call("XSync", 0)

    def hand_over(self, request, text):
        self.call("XChangeProperty", request.requestor, request.property, request.target, 8, REPLACE, text, len(text))
        event = Event()
        event.notify = SelectionNotify(type=SELECTION_NOTIFY, requestor=request.requestor, selection=request.selection,
                                       target=request.target, property=request.property, time=request.time)
        self.call("XSendEvent", request.requestor, 0, 0, byref(event))
        self.call("XSync", 0)
