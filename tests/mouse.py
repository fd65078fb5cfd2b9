# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand at the mouse and the keys of softfall-gui on the display of test_gui, by xdotool and its library:

    mouse.py button NAME                 clicks on a button of the tree, and prints where
    mouse.py monkey SEED EVENTS COMMAND  starts the command in the present folder, which prints a line when its window is there, and
                                         does that many random things in it, again each time that they have closed it; exits with 1
                                         if the window ends otherwise, does not answer, or leaves a program behind
    mouse.py wild SEED EVENTS COMMAND    the same with gmsh's menus, which may end the window or keep it from answering: then it is
                                         killed, and must leave no program behind either
"""
import ctypes
import glob
import os
import random
import signal
import struct
import subprocess
import sys
import time

BUTTONS = ["mesh", "run", "stop", "report", "paraview", "save"]  # of the tree, from top to bottom
SCREEN = "Xvfb_screen0"  # that Xvfb -fbdir keeps in the folder of the tests, in the format of xwd


def column(x):
    """The brightness of the pixels of a column of the screen, 0 to 255."""
    with open(os.path.join(os.environ["SCREEN_FOLDER"], SCREEN), "rb") as file:
        data = file.read()
    size, height, line, colours = (struct.unpack_from(">I", data, 4 * k)[0] for k in (0, 5, 12, 19))
    start = size + 12 * colours + 4 * x  # A pixel has 32 bits, of which three bytes are its colour.
    return [max(data[start + y * line:start + y * line + 4]) for y in range(height)]


def xdotool(*words):
    return subprocess.run(["xdotool", *map(str, words)], capture_output=True, text=True)


def find_window(patience=60):
    """x, y, width and height of the main window; None if it does not come."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        for number in xdotool("search", "--onlyvisible", "--name", ".").stdout.split():
            found = dict(line.split("=") for line in xdotool("getwindowgeometry", "--shell", number).stdout.split())
            if int(found.get("WIDTH", 0)) > 600:
                return [int(found[key]) for key in ("X", "Y", "WIDTH", "HEIGHT")]
        time.sleep(0.1)
    return None


def find_buttons(window):
    """Waits for the buttons, and returns their places: rows of the tree that are neither white nor a line."""
    x, y, _, height = window
    for _ in range(300):
        places, thick, inside, outside = [], 0, column(x + 60), column(x + 398)
        for row in range(y, y + height):
            if inside[row] < 250 <= outside[row]:
                thick += 1
                continue
            if thick >= 12:
                places.append((x + 120, row - thick // 2))
            thick = 0
        if len(places) >= len(BUTTONS):
            return places[:len(BUTTONS)]
        time.sleep(0.2)
    sys.exit("there are no buttons")


KEYS = [*"0123456789xm", "period", "minus", "slash", "Return", "Return", "Tab", "BackSpace", "Delete", "Escape", "Escape", "Up", "Down", "Left", "Right", "Home", "End",
        "Page_Down", "F5", "ctrl+a", "ctrl+z", "ctrl+Return", "alt+m", "shift+Tab"]


class Hand:
    """Moves, clicks and presses keys at once, without a program for each; `close` is the key that closes the window."""

    def __init__(self):
        self.library = ctypes.CDLL("libxdo.so.3")
        self.library.xdo_new.restype = ctypes.c_void_p
        self.display = ctypes.c_void_p(self.library.xdo_new(None))

    def click(self, place, button=1, way=(0, 0)):
        """Presses a button at the place, and releases it some way from there."""
        self.library.xdo_move_mouse(self.display, *place, 0)
        self.library.xdo_mouse_down(self.display, ctypes.c_ulong(0), button)
        if way != (0, 0):
            self.library.xdo_move_mouse(self.display, place[0] + way[0], place[1] + way[1], 0)
        self.library.xdo_mouse_up(self.display, ctypes.c_ulong(0), button)

    def key(self, name):
        self.library.xdo_send_keysequence_window(self.display, ctypes.c_ulong(0), name.encode(), 1000)

    def close(self, window):
        self.library.xdo_move_mouse(self.display, window[0] + 900, window[1] + 600, 0)
        self.key("ctrl+q")


def do_at_random(dice, hand, window, places, menus):
    """Does one thing that a monkey does; it closes the window once in more than a hundred times."""
    x, y, width, height = window
    tree = (x + dice.randint(5, 410), y + 24 + int((height - 60) * dice.random() ** 2))
    picture = (x + dice.randint(420, width - 5), y + dice.randint(25, height - 40))
    what = dice.choices(["button", "run", "tree", "edit", "wheel", "picture", "drag", "menu", "bar", "key", "close"],
                        [20, 5, 17, 10, 6, 8, 5, 3 if menus else 0, 5, 20, 0.7])[0]
    if what == "close":
        hand.close(window)
    elif what == "key":
        hand.key(dice.choice(KEYS))
    elif what == "edit":
        hand.click(tree)
        for name in ("ctrl+a", dice.choice("123456789"), dice.choice("0123456789"), "Return"):
            hand.key(name)
    elif what == "drag":
        hand.click(picture, dice.randint(1, 3), (dice.randint(-80, 80), dice.randint(-80, 80)))
    else:
        place = {"button": dice.choice(places), "run": (x + 338, y + height - 38), "tree": tree, "wheel": dice.choice([tree, picture]),
                 "picture": picture, "menu": (x + dice.randint(5, 180), y + 12), "bar": (x + dice.randint(5, 220), y + height - 10)}[what]
        hand.click(place, dice.choice([4, 5]) if what == "wheel" else dice.choice([1, 1, 1, 1, 3]))


def programs_here():
    """Processes of softfall and gmsh that the test has started, by the folder in their environment."""
    found = []
    for path in glob.glob("/proc/[0-9]*"):
        try:
            with open(path + "/comm") as comm, open(path + "/environ", "rb") as environ:
                name = comm.read().strip()
                if name.startswith(("softfall", "gmsh")) and b"XDG_CACHE_HOME=" + os.environ["XDG_CACHE_HOME"].encode() in environ.read().split(b"\0"):
                    found.append(f"{name} ({path})")
        except OSError:
            pass
    return found


def wait_until(true, seconds):
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.1)
    return true()


def play(dice, hand, left, command, wild):
    """One window, until it is closed or nothing is left to do; how much is left then."""
    gui = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    if not gui.stdout.readline():
        sys.exit("the window does not come")
    window = find_window()
    places = find_buttons(window)
    while left > 0 and gui.poll() is None:
        do_at_random(dice, hand, window, places, wild)
        time.sleep(0.02)
        left -= 1
    for _ in range(3 if wild else 60):  # It answers if it lets itself be closed.
        if gui.poll() is None:
            hand.key("Escape")
            hand.close(window)
            wait_until(lambda: gui.poll() is not None, 1)
    if gui.poll() is None:
        gui.send_signal(signal.SIGKILL if wild else signal.SIGABRT)
        if not wild:
            sys.exit("the window does not answer")
    if gui.wait() != 0 and not wild:
        sys.exit(f"the window has ended with {gui.returncode}, {left} events before the end")
    if not wait_until(lambda: not programs_here(), 40):
        sys.exit(f"left behind: {programs_here()}")
    return left


def monkey(seed, left, command, wild):
    dice, hand, windows = random.Random(seed), Hand(), 0
    while left > 0:
        left, windows = play(dice, hand, left, command, wild), windows + 1
    print(windows, "windows")


if __name__ == "__main__":
    if sys.argv[1] == "button":
        place = find_buttons(find_window())[BUTTONS.index(sys.argv[2])]
        print(place)
        xdotool("mousemove", *place, "sleep", 0.3, "click", 1)
    else:
        monkey(int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:], sys.argv[1] == "wild")
