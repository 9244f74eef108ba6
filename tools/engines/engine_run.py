# GPL-2.0-or-later. Runs ioquake3 without a display, for pictures of maps.
"""The engine gets a home folder of its own with the maps in it, and draws with Mesa's software OpenGL under Xvfb."""

import math
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

# From the position of setviewpos to the eye, in units. Up: 1 by the teleport, and the view height of 26. Ahead: the
# teleport throws the player forward at 400 units a second, and friction stops a player in noclip after this distance.
EYE_HEIGHT, SLIDE = 27, 36.04
MODEL_DISTANCE = 100  # units from the eye to the model that testmodel shows
SETTLE = "wait 40"  # until the eye stands still, at FRAMES a second
FRAMES = 50

SETTINGS = {
    "bot_enable": 0, "cg_bobpitch": 0, "cg_bobroll": 0, "cg_bobup": 0, "cg_draw2D": 0, "cg_drawGun": 0, "cg_fov": 90,
    "cg_runpitch": 0, "cg_runroll": 0, "cg_thirdPerson": 0, "com_introplayed": 1, "com_maxfps": FRAMES,
    "con_notifytime": 0, "g_gametype": 0, "g_inactivity": 0, "pmove_fixed": 1, "pmove_msec": 8,
    "r_ext_compressed_textures": 0, "r_ext_multisample": 0, "r_flares": 0, "r_fullscreen": 0, "r_gamma": 1,
    "r_intensity": 1, "r_mode": -1, "r_picmip": 0, "s_initsound": 0, "timelimit": 0,
}


class EngineError(Exception):
    """The engine cannot be run, or refused the map."""


def need(*programs):
    """Raises EngineError unless all of these programs are installed."""
    packages = {"xvfb-run": "xvfb", "convert": "imagemagick", "montage": "imagemagick"}
    missing = [name for name in programs if not shutil.which(name)]
    if missing:
        wanted = sorted({packages.get(name, name) for name in missing})
        raise EngineError(f"{', '.join(missing)} missing: install {' '.join(wanted)}")


class Engine:
    """An engine with a game, and how it draws. settings: console variables in addition to SETTINGS."""

    def __init__(self, path, game, mod, renderer, size=(800, 600), settings=None):
        self.path, self.game, self.mod, self.renderer, self.size = Path(path), Path(game), mod, renderer, size
        self.settings = settings or {}
        need("xvfb-run")
        if not os.access(self.path, os.X_OK):
            raise EngineError(f"{path}: no engine there")
        if not (self.game / mod).is_dir():
            raise EngineError(f"{self.game / mod}: no game data there")

    def run(self, bsp, commands, files=None, seconds=600):
        """Loads a map with cheats and runs console commands. files: bytes by path in the mod's folder. Returns the log,
        the folder of screenshots, and the temporary folder around it, which is deleted with its last reference."""
        home = tempfile.TemporaryDirectory(prefix="engine_run_")
        mod = Path(home.name) / self.mod
        (mod / "maps").mkdir(parents=True)
        shutil.copy(bsp, mod / "maps")
        for name, data in (files or {}).items():
            (mod / name).parent.mkdir(parents=True, exist_ok=True)
            (mod / name).write_bytes(data)
        width, height = self.size
        settings = SETTINGS | {"r_customwidth": width, "r_customheight": height} | self.settings
        (mod / "autoexec.cfg").write_text("".join(f'set {name} "{value}"\n' for name, value in settings.items()))
        (mod / "pictures.cfg").write_text("\n".join(["wait 20", *commands, "wait 5", "quit", ""]))
        log = self._start(home.name, Path(bsp).stem, seconds)
        if refused := re.search(r"^(ERROR: .*|.*crashed: .*)$", log, re.M):
            raise EngineError(f"{bsp}: {refused[1]}")
        return log, mod / "screenshots", home

    def _start(self, home, name, seconds):
        words = ["xvfb-run", "-a", "-s", f"-screen 0 {self.size[0]}x{self.size[1]}x24", str(self.path.resolve())]
        start = {"fs_basepath": self.game.resolve(), "fs_homepath": home, "com_basegame": self.mod,
                 "com_standalone": 1, "com_hunkMegs": 512, "cl_renderer": self.renderer, "sv_pure": 0,
                 "vm_game": 0, "vm_cgame": 0, "vm_ui": 0}
        for variable, value in start.items():
            words += ["+set", variable, str(value)]
        words += ["+devmap", name, "+exec", "pictures.cfg"]
        surroundings = os.environ | {"SDL_AUDIODRIVER": "dummy", "LIBGL_ALWAYS_SOFTWARE": "1"}
        try:
            done = subprocess.run(words, env=surroundings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, timeout=seconds, check=False)
        except subprocess.TimeoutExpired as error:
            raise EngineError(f"the engine did not end within {seconds} seconds") from error
        return done.stdout.decode(errors="replace")


def view(eye, yaw):
    """Console command that moves the eye. yaw: degrees. The player must be in noclip."""
    x, y, z = eye
    angle = math.radians(yaw)
    ahead = (SLIDE * math.cos(angle), SLIDE * math.sin(angle))
    return f"setviewpos {x - ahead[0]:.3f} {y - ahead[1]:.3f} {z - EYE_HEIGHT:.3f} {yaw:g}"


def eye_before(center, yaw):
    """Position of the eye for which testmodel shows a model at that center. yaw: of the view, degrees."""
    x, y, z = center
    angle = math.radians(yaw)
    return x - MODEL_DISTANCE * math.cos(angle), y - MODEL_DISTANCE * math.sin(angle), z
