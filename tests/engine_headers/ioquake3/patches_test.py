# GPL-2.0-or-later. tools/engines/ioquake3/apply on a tree that has the lines which the patches expect, and nothing else.
"""patches_test.py FOLDER: the folder of the integration. Exit status 77 without the program patch."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HUNK = re.compile(r'@@ -(\d+),(\d+) \+(\d+),(\d+) @@')


def read_hunks(patch):
    """(file, first line, lines before, lines after) of each hunk; checks the numbers of its head."""
    hunks, lines, at = [], patch.read_text().splitlines(), 0
    name = None
    while at < len(lines):
        if lines[at].startswith('--- a/'):
            name = lines[at][6:]
            assert lines[at + 1] == f'+++ b/{name}', f'{patch.name}: {lines[at + 1]}'
            at += 2
        head = HUNK.match(lines[at])
        assert name and head, f'{patch.name}, line {at + 1}: no head of a hunk'
        first, old_count, _, new_count = map(int, head.groups())
        old, new, at = [], [], at + 1
        while at < len(lines) and len(old) + len(new) < old_count + new_count:
            old += [lines[at][1:]] if lines[at][0] in ' -' else []
            new += [lines[at][1:]] if lines[at][0] in ' +' else []
            at += 1
        assert (len(old), len(new)) == (old_count, new_count), f'{patch.name}: lines of {head.group()}'
        hunks.append((name, first, old, new))
    return hunks


def make_tree(folder, hunks):
    """Each file with the old lines of its hunks where they belong, numbered lines between them."""
    files = {'code/qcommon/qfiles.h': []}
    for name, first, old, _ in hunks:
        text = files.setdefault(name, [])
        assert len(text) < first, f'{name}: hunks overlap or are out of order'
        text += [f'line {number}' for number in range(len(text) + 1, first)] + old
    for folder_of_engine in ('code/renderercommon', 'code/renderergl1', 'code/renderergl2', 'cmake'):
        (folder / folder_of_engine).mkdir(parents=True)
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(''.join(f'{line}\n' for line in text))


def read_tree(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob('*') if path.is_file()}


def main():
    if not shutil.which('patch'):
        return 77
    engine = Path(sys.argv[1])
    patches = sorted(engine.glob('*.patch'))
    assert patches
    hunks = [hunk for patch in patches for hunk in read_hunks(patch)]

    def apply(folder):
        return subprocess.run([engine / 'apply', folder], capture_output=True, text=True)

    with tempfile.TemporaryDirectory() as place:
        tree = Path(place) / 'tree'
        make_tree(tree, hunks)
        original = read_tree(tree)

        # A line that a patch needs is missing: nothing is changed.
        broken = tree / hunks[-1][0]
        broken.write_text(broken.read_text().replace(hunks[-1][2][0], 'another line'))
        before = read_tree(tree)
        result = apply(tree)
        assert result.returncode == 1 and 'does not fit' in result.stderr, result.stderr
        assert read_tree(tree) == before
        broken.write_bytes(original[hunks[-1][0]])

        result = apply(tree)
        assert result.returncode == 0, result.stderr
        changed = read_tree(tree)
        for name, _, _, new in hunks:
            assert ''.join(f'{line}\n' for line in new).encode() in changed[name], f'{name}: not as in the patch'
        for source in (engine / 'source').rglob('*.[ch]'):
            name = source.relative_to(engine / 'source').as_posix()
            assert changed[name] == source.read_bytes()
            # What the build of the engine needs to find.
            if name.endswith('.c'):
                lists = b''.join(text for path, text in changed.items() if path.startswith('cmake/'))
                assert name.removeprefix('code/').encode() in lists, f'{name} is in no list of sources'
        assert 'code/renderercommon/shgrid.h' in changed

        result = apply(tree)
        assert result.returncode == 1 and 'applied already' in result.stderr, result.stderr
        assert read_tree(tree) == changed
    return 0


sys.exit(main())
