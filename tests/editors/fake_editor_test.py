#!/usr/bin/env python3
# GPL-2.0-or-later. The menus of tools/generated/editors, read, expanded and run as editors do.
"""usage: fake_editor_test.py PROGRAM [unittest options]"""

import importlib.machinery
import importlib.util
import os
import platform
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
TOOLS = Path(__file__).resolve().parents[2] / "tools"
SCRIPTS, EDITORS = TOOLS / "scripts/editors", TOOLS / "generated/editors"
sys.path.insert(0, str(SCRIPTS))
import menus


def load_fake_editor():
    loader = importlib.machinery.SourceFileLoader("fake_editor", str(SCRIPTS / "fake_editor"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("fake_editor", loader))
    sys.modules["fake_editor"] = module
    loader.exec_module(module)
    return module


fake_editor = load_fake_editor()
FILES = [EDITORS / name for name in ("netradiant/default_build_menu.xml", "gtkradiant/default_project.proj",
                                     "trenchbroom/CompilationProfiles.cfg")]
PROGRAM = ""


def box(low, high):
    """A brush with axial sides."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    sides = [((x0, y0, z0), (x0, y1, z0), (x0, y0, z1)), ((x1, y0, z0), (x1, y0, z1), (x1, y1, z0)),
             ((x0, y0, z0), (x0, y0, z1), (x1, y0, z0)), ((x0, y1, z0), (x1, y1, z0), (x0, y1, z1)),
             ((x0, y0, z0), (x1, y0, z0), (x0, y1, z0)), ((x0, y0, z1), (x0, y1, z1), (x1, y0, z1))]
    lines = [" ".join(f"( {x} {y} {z} )" for x, y, z in points) + " room/wall 0 0 0 0.5 0.5 0 0 0" for points in sides]
    return "{\n" + "\n".join(lines) + "\n}\n"


def room_map(hole=False):
    """A room of 512 x 256 x 192 units with a wall in it, a light and a place to stand."""
    x, y, z, t = 512, 256, 192, 16
    walls = [box((-t, -t, -t), (x + t, y + t, 0)), box((-t, -t, z), (x + t, y + t, z + t)),
             box((-t, 0, 0), (0, y, z)), box((-t, -t, 0), (x + t, 0, z)), box((-t, y, 0), (x + t, y + t, z)),
             box((240, 0, 0), (256, 160, z))]
    if not hole:
        walls.append(box((x, 0, 0), (x + t, y, z)))
    return ('{\n"classname" "worldspawn"\n' + "".join(walls) + "}\n"
            '{\n"classname" "info_player_start"\n"origin" "64 64 32"\n}\n'
            '{\n"classname" "light"\n"origin" "384 128 128"\n"light" "300"\n"_color" "1 0.6 0.3"\n}\n')


class Game:
    """A game folder, with a blank in its path, and an editor's folder."""

    def __init__(self, test, hole=False):
        temporary = tempfile.TemporaryDirectory()
        test.addCleanup(temporary.cleanup)
        root = Path(temporary.name)
        self.engine = root / "my games"
        self.maps = self.engine / "baseq3" / "maps"
        self.maps.mkdir(parents=True)
        (self.engine / "baseq3" / "scripts").mkdir()
        self.map = self.maps / "room.map"
        self.map.write_text(room_map(hole))
        self.texture = self.engine / "baseq3" / "textures" / "room" / "wall.tga"
        self.texture.parent.mkdir(parents=True)
        # Two by two pixels of 24 bits, uncompressed.
        self.texture.write_bytes(struct.pack("<3B5x4H2B", 0, 0, 2, 0, 0, 2, 2, 24, 0) + bytes(range(100, 112)))
        editor = root / "editor"
        editor.mkdir()
        self.editor = fake_editor.link_program(PROGRAM, editor)

    def setup(self):
        return menus.Setup(editor=self.editor, engine=f"{self.engine}/", home=f"{self.engine}/",
                           map_file=str(self.map), executable_type=platform.machine(), tool=PROGRAM)

    def run(self, file, label, monitor=True):
        setup = self.setup()
        if not monitor:
            setup.monitor = ""
        return fake_editor.run_entry(file, label, setup, fake_editor.Console(quiet=True))

    def lump(self, number):
        data = (self.maps / "room.bsp").read_bytes()
        offset, length = struct.unpack_from("<2i", data, 8 + 8 * number)
        return data[offset:offset + length]


class Expansion(unittest.TestCase):
    """Test vectors of the three forms."""

    MENU = """<?xml version="1.0"?>
<project version="2.0">
<var name="q3map2">"[RadiantPath]q3map2.[ExecutableType]" -v<cond value="[MonitorAddress]"> -connect [MonitorAddress]\
</cond> -game quake3 -fs_basepath "[EnginePath]" -fs_homepath "[UserEnginePath]"<cond value="[GameName]"> -fs_game \
[GameName]</cond></var>
<build name="bsp"><command>[q3map2] -meta -samplesize 32 "[MapFile]"</command><command></command></build>
</project>"""
    SETUP = menus.Setup(editor="/opt/nrc/", engine="/g/q3/", home="/h/.q3a/", extra_paths=["/d/tex"],
                        map_file="/g/q3/baseq3/maps/a.map")

    def test_brackets(self):
        steps = menus.read_build_menu(self.MENU)[0].steps(self.SETUP)
        self.assertEqual([step.command for step in steps], [
            '"/opt/nrc/q3map2.x86_64" -v -fs_pakpath "/d/tex" -connect 127.0.0.1:39000 -game quake3 '
            '-fs_basepath "/g/q3/" -fs_homepath "/h/.q3a/" -fs_game baseq3 -meta -samplesize 32 '
            '"/g/q3/baseq3/maps/a.map"'])

    def test_odd_brackets(self):
        self.assertEqual(menus.expand_brackets("a]b[x]c[none]d[x", {"x": "[x]"}), "a]b[x]cd")
        names = []
        menus.expand_brackets("[a[b]", {}, names)
        self.assertEqual(names, ["a[b"])

    def test_variables_see_those_before_them(self):
        menu = ('<project version="2.0"><var name="b">[a]2</var><var name="a">1</var><var name="b">3</var>'
                '<build name="x"><command>[b]</command></build></project>')
        self.assertEqual(menus.read_build_menu(menu)[0].steps(self.SETUP)[0].command, "123")

    def test_version_of_build_menus(self):
        for text in ("<project/>", '<project version="2.1"/>', '<project version="1.0"/>'):
            self.assertRaises(menus.MenuError, menus.read_build_menu, text)

    def test_marks_of_projects(self):
        setup = menus.Setup(editor="/opt/gtk/", engine="/g/q3/", map_file="/g/q3/baseq3/maps/a.map")
        value = ('! "$TEMPLATEapppath$TEMPLATEq3map2" -v # -game quake3 -fs_basepath "$TEMPLATEenginepath" -meta $ '
                 "&& ! @x@ & y # $")
        first, second = menus.project_steps(value, setup)
        self.assertEqual(first.command, ' "/opt/gtk/q3map2" -v  -connect 127.0.0.1:39000  -game quake3 '
                         '-fs_basepath "/g/q3/" -meta "/g/q3/baseq3/maps/a.map" ')
        setup.game, setup.monitor = "mod", ""
        second = menus.project_steps(value, setup)[1]
        self.assertEqual(second.command, '  "x" & y  -fs_game mod "/g/q3/baseq3/maps/a.map"')

    def test_parameters_of_profiles(self):
        setup = menus.Setup(editor="/tb/", engine="/g/q3 x/", map_file="/m/a.map", tool="/opt/q3map2")
        profiles = ('// comment\n{ version: 1, "profiles": [ { "name": "n", "workdir": "${GAME_DIR_PATH}/${MODS[-1]}", '
                    '"tasks": [ { "type": "tool", "tool": "${q3map2}", "parameters": "-v -threads ${CPU_COUNT} -game '
                    'quake3 -fs_basepath \\"${GAME_DIR_PATH}\\" -fs_game ${MODS[-1]} -meta \\"${MAP_BASE_NAME}.map\\""'
                    " } ] } ] }")
        step = menus.read_profiles(profiles)[0].steps(setup)[0]
        self.assertEqual(step.arguments, ["/opt/q3map2", "-v", "-threads", "2", "-game", "quake3", "-fs_basepath",
                                          "/g/q3 x", "-fs_game", "baseq3", "-meta", "a.map"])
        self.assertEqual(step.folder, "/g/q3 x/baseq3")
        self.assertEqual(menus.split_parameters('a="b c" d'), ["b c", "d"])
        self.assertRaises(menus.MenuError, menus.read_profiles, profiles.replace("} ] }", "}, ] }", 1))


class Menus(unittest.TestCase):
    def test_editors_offer_the_same(self):
        labels = [[entry.label for entry in menus.read_menu(file) if entry] for file in FILES]
        self.assertGreater(len(labels[0]), 8)
        self.assertEqual(labels[0], labels[1])
        self.assertEqual(labels[0], labels[2])

    def test_the_game_configuration_has_what_profiles_need(self):
        folder = EDITORS / "trenchbroom"
        config = menus.ExpressionReader((folder / "GameConfig.cfg").read_text()).whole()
        self.assertEqual(config["version"], 9.0)
        for key in ("name", "fileformats", "filesystem", "materials", "entities"):
            self.assertIn(key, config)
        tools = {tool["name"] for tool in config["compilationTools"]}
        profiles = menus.ExpressionReader((folder / "CompilationProfiles.cfg").read_text()).whole()["profiles"]
        named = {task["tool"] for profile in profiles for task in profile["tasks"] if task["type"] == "tool"}
        self.assertLessEqual(named, {f"${{{tool}}}" for tool in tools})
        bits = config["faceattribs"]["contentflags"]
        self.assertEqual([1 << i for i, bit in enumerate(bits) if bit.get("name") == "detail"], [0x8000000])
        tags = config["tags"]["brush"] + config["tags"]["brushface"]
        self.assertEqual(len({tag["name"] for tag in tags}), len(tags))

    def test_every_entry_of_every_editor(self):
        """In the order of the menu, on one map; nothing fails, and no option is unknown or without effect."""
        results = []
        for file in FILES:
            game = Game(self)
            for entry in (e for e in menus.read_menu(file) if e and not e.label.startswith("Watch")):
                for outcome in game.run(file, entry.label):
                    where = f"{file.name}, {entry.label}: {outcome.command}\n{outcome.text}"
                    self.assertEqual((outcome.status, outcome.stopped), (0, ""), where)
                    self.assertFalse(outcome.feedback.failed, where)
                    for complaint in ("Unknown", "without effect", "no effect"):
                        self.assertNotIn(complaint, outcome.text, where)
                    if not outcome.command.startswith("export"):
                        self.assertIn("\ndone: ", outcome.text, where)
            self.assertEqual(struct.unpack_from("<i", (game.maps / "room.bsp").read_bytes(), 4)[0], 46)
            results.append([game.lump(number) for number in range(1, 17)])
            self.assertTrue((game.engine / "room_autopacked.pk3").exists())
        self.assertEqual(results[0], results[1])
        self.assertEqual(results[0], results[2])

    def test_watch_runs_until_it_is_stopped(self):
        for file in FILES:
            game = Game(self)
            entry = next(e for e in menus.read_menu(file) if e and e.label.startswith("Watch"))
            step = entry.steps(game.setup())[-1]
            # Without applications there is no browser that -open could start.
            environment = {**os.environ, **{f"XDG_{name}": str(game.engine) for name in
                                            ("DATA_DIRS", "DATA_HOME", "CONFIG_HOME", "CONFIG_DIRS")}}
            line = step.arguments or ["/bin/sh", "-c", f"exec {step.command}"]
            with subprocess.Popen(line, cwd=step.folder or None, env=environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True) as run:
                text = ""
                for printed in run.stdout:
                    text += printed
                    if "has no -watch" in text:
                        break
                    if printed.startswith("Draft light"):
                        run.send_signal(signal.SIGINT)
                status = run.wait()
            if "has no -watch" in text:
                self.skipTest("no -watch in this build")
            self.assertEqual(status, 0, text)
            self.assertIn("Draft light after", text)
            self.assertNotIn("Unknown", text)

    def test_what_entries_do(self):
        game = Game(self)
        game.run(FILES[0], "Normal with SH grid: bsp, vis, light")
        lit = [game.lump(number) for number in range(17)]
        self.assertIn(b"LIGHTGRID_SH", (game.maps / "room.bsp").read_bytes())
        self.assertTrue((game.maps / "room.prt").exists(), "for editors that draw portals")
        game.map.write_text(game.map.read_text().replace('"64 64 32"', '"64 96 32"\n"message" "moved"'))
        game.run(FILES[0], "Entities only")
        self.assertIn(b'"message" "moved"', game.lump(0))
        self.assertEqual(lit[1:], [game.lump(number) for number in range(1, 17)])
        game.run(FILES[0], "SH grid only, draft")
        self.assertEqual(lit[14], game.lump(14), "lightmaps stay")

    def test_a_leak_is_shown_and_stops_the_build(self):
        game = Game(self, hole=True)
        outcomes = game.run(FILES[0], "Normal: bsp, vis, light")
        self.assertEqual(len(outcomes), 1)
        feedback = outcomes[0].feedback
        self.assertEqual(outcomes[0].stopped, "an error arrived")
        self.assertEqual(feedback.events[-3:], ["select", "trail", "message"])
        self.assertEqual(feedback.selects[-1], ("Entity 2, Brush 0: the light at 384 128 128 can be reached from "
                                                "outside the map", (2, 0)))
        lines = (game.maps / "room.lin").read_text().splitlines()
        self.assertEqual(feedback.trails[0], [tuple(float(word) for word in line.split()) for line in lines])
        # GtkRadiant goes on, TrenchBroom stops at the exit status of -vis.
        self.assertEqual([bool(o.status) for o in game.run(FILES[1], "Normal: bsp, vis, light")], [False, True, False])
        outcomes = game.run(FILES[2], "Normal: bsp, vis, light")
        self.assertIn("because the map leaked", outcomes[-1].text)
        self.assertEqual([o.status for o in outcomes], [0, 0, 1])

    def test_every_failure_arrives_as_an_error(self):
        """Editors do not look at the exit status."""
        game = Game(self)
        game.run(FILES[0], "Draft: bsp, vis, light")
        game.texture.unlink()
        outcome = game.run(FILES[0], "Package (pk3)")[0]
        self.assertEqual((outcome.status, outcome.stopped), (1, "an error arrived"))
        self.assertIn("textures/room/wall", outcome.text)
        (game.maps / "room.prt").unlink()
        (game.maps / "room.bsp").unlink()
        outcome = game.run(FILES[0], "SH grid only, draft")[0]
        self.assertEqual((outcome.status, outcome.stopped), (1, "an error arrived"))

    def test_without_monitoring(self):
        game = Game(self)
        for file in FILES[:2]:
            outcomes = game.run(file, "Draft: bsp, vis, light", monitor=False)
            self.assertEqual([o.status for o in outcomes], [0, 0, 0])
            self.assertFalse(any("-connect" in o.command for o in outcomes))

    def test_a_command_that_does_not_connect(self):
        game = Game(self)
        menu = game.map.with_name("menu.xml")
        menu.write_text('<project version="2.0"><build name="x"><command>true [MonitorAddress]</command>'
                        "<command>false</command></build></project>")
        fake_editor.WAIT[".xml"], seconds = 0.2, fake_editor.WAIT[".xml"]
        outcomes = game.run(menu, "x")
        fake_editor.WAIT[".xml"] = seconds
        self.assertEqual([o.stopped for o in outcomes], ["no connection within 0.2 s"])


class OtherCalls(unittest.TestCase):
    """What NetRadiant starts besides its menu; the program's path is not quoted."""

    def call(self, game, words):
        command = (f'{game.editor}q3map2.{platform.machine()} {words[0]} -fs_basepath "{game.engine}/" '
                   f'-fs_homepath "{game.engine}/" -fs_game baseq3 {words[1]}')
        return subprocess.run(["/bin/sh", "-c", command], capture_output=True, text=True, check=False)

    def test_auto_caulk(self):
        game = Game(self)
        (game.maps / "room_ac.map").write_text(room_map())
        run = self.call(game, ("-game quake3", f'-autocaulk -fulldetail "{game.maps}/room_ac.map"'))
        self.assertEqual(run.returncode, 0, run.stdout)
        letters = dict(line.split() for line in (game.maps / "room_ac.caulk").read_text().splitlines())
        self.assertEqual(letters, {"0": "ccccc-", "1": "cccc-c", "2": "c-cccc", "3": "ccc-cc", "4": "cc-ccc",
                                   "5": "--c-cc", "6": "-ccccc"})

    def test_converted_maps(self):
        listed = subprocess.run([PROGRAM, "-help"], capture_output=True, text=True, check=True).stdout
        if "-convert" not in listed:
            self.skipTest("no -convert in this version")
        game = Game(self)
        game.run(FILES[0], "Draft: bsp, vis, light")
        for form, options in (("map", '"%s.bsp"'), ("map_bp", '"%s.bsp"'), ("map_bp", '-readmap  "%s.map"')):
            converted = game.maps / "room_converted.map"
            converted.unlink(missing_ok=True)
            run = self.call(game, ("-v -game quake3", f"-convert -format {form} {options % (game.maps / 'room')}"))
            self.assertEqual(run.returncode, 0, run.stdout)
            self.assertGreaterEqual(converted.read_text().count("( "), 7 * 6 * 3)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
