#!/usr/bin/env python3
# GPL-2.0-or-later. Whether viewer.html was built from the sources that are beside it: source_hash.js tells of what.
"""usage: page_is_current.py tools/viewer"""
import hashlib
import pathlib
import re
import sys

MARKER = '<!-- package -->'
MOST_BYTES = 900_000
FILES = ['index.html', 'package-lock.json', 'package.json', 'source_hash.js', 'vite.config.js']


def source_hash(folder):
    below = [path.relative_to(folder).as_posix() for path in (folder / 'src').rglob('*') if path.is_file()]
    digest = hashlib.sha256()
    for path in sorted(FILES + below):
        data = (folder / path).read_bytes()
        digest.update(f'{path}\0{len(data)}\0'.encode())
        digest.update(data)
    return digest.hexdigest()


def faults(folder):
    page = (folder / 'viewer.html').read_text(encoding='utf-8')
    found = re.search(r'<meta name="source-sha256" content="([0-9a-f]{64})">', page)
    if not found or found[1] != source_hash(folder):
        yield 'viewer.html is not built from these sources: run tools/viewer/build'
    if page.count(MARKER) != 1:
        yield f'viewer.html must contain {MARKER} once'
    if len(page.encode()) > MOST_BYTES:
        yield f'viewer.html has {len(page.encode())} bytes, more than {MOST_BYTES}'
    if re.search(r'<(script|link|img)[^>]* (src|href)="(?!data:)', page):
        yield 'viewer.html refers to other files'


messages = list(faults(pathlib.Path(sys.argv[1])))
print('\n'.join(messages) or 'viewer.html is current')
sys.exit(1 if messages else 0)
