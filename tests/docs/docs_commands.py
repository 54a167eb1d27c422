#!/usr/bin/env python3
"""Runs the commands of a page: docs_commands.py SOURCE BUILD PAGE [--slow]

The ```sh blocks of PAGE (a path within SOURCE) are run in order, by one bash
that stops at the first failure, in a scratch folder that looks like a checkout
with a finished BUILD. tests/docs/docs_exceptions.py lists the commands that are
replaced or left out (slow ones only without --slow), and what a page needs
before its commands are run.

Tools that would install packages or build are replaced by stand-ins, which only
check that their arguments (a preset, for example) exist.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import docs_exceptions

FOLDERS = ('core robust costs frontend apps benchmarks tests docs '
           'scripts').split()
TIMEOUT = 290  # s
SKIPPED = 77  # exit code for ctest

# cmake checks presets, installs, and builds projects other than this one.
CMAKE = r'''#!/usr/bin/env bash
set -euo pipefail
real=@CMAKE@
has_preset() {
  "$real" "${@:2}" --list-presets | grep -qF "\"$1\"" ||
    { echo "cmake: there is no preset $1" >&2; exit 1; }
}
case "$*" in
  "--preset "*) has_preset "$2" ;;
  "--build --preset "*) has_preset "$3" --build ;;
  *"-S . -B build "* | "--build build" | "--build build "*) ;;
  "--install build"*) exec "$real" --install @BUILD@ "${@:3}" ;;
  *) exec "$real" "$@" ;;
esac
'''


def commands(page):
    """Yields (first line, last line, text) of each command in sh blocks.

    Lines count from 0. Text is without a comment, on one line.
    """
    language = None
    begin = None
    end_of_document = None  # of a here-document, whose lines are no commands
    for number, line in enumerate(page):
        fence = re.match(r'```(\w*)', line)
        if fence:
            language = None if language is not None else fence.group(1)
            continue
        if language != 'sh':
            continue
        if end_of_document is not None:
            if line == end_of_document:
                end_of_document = None
            continue
        if begin is None:
            begin = number
        here = re.search(r"<<'?(\w+)'?", line)
        if here:
            end_of_document = here.group(1)
        if line.endswith('\\'):
            continue
        text = ' '.join(part.rstrip('\\') for part in page[begin:number + 1])
        text = ' '.join(re.sub(r'(^|\s)#.*', '', text).split())
        if text:
            yield begin, number, text
        begin = None


def script(page_name, page, exceptions):
    """The page as a script with the same line numbers."""
    lines = [''] * len(page)
    language = None
    for number, line in enumerate(page):
        fence = re.match(r'```(\w*)', line)
        if fence:
            language = None if language is not None else fence.group(1)
        elif language == 'sh':
            lines[number] = line
    used = set()
    count = 0
    for begin, end, text in commands(page):
        count += 1
        if '&&' in text:  # bash would continue if the first of two fails
            lines[begin] = text + ' || false'
            lines[begin + 1:end + 1] = [''] * (end - begin)
        if text not in exceptions:
            continue
        used.add(text)
        lines[begin] = exceptions[text].run.rstrip()
        lines[begin + 1:end + 1] = [''] * (end - begin)
    unused = sorted(set(exceptions) - used)
    if unused:
        sys.exit(f'{page_name}: tests/docs/docs_exceptions.py lists what the page '
                 'no longer says:\n  ' + '\n  '.join(unused))
    # Replaces the page's title.
    lines[0] = ('set -euo pipefail; trap \'echo "FAILED: %s:$LINENO: '
                '$BASH_COMMAND" >&2\' ERR' % page_name)
    return '\n'.join(lines) + '\n', count


def make_checkout(source, build, scratch):
    """Links to the sources, a finished build, and the stand-ins."""
    for entry in source.iterdir():
        if entry.is_file():
            (scratch / entry.name).symlink_to(entry)
        elif entry.name in FOLDERS:
            shutil.copytree(entry, scratch / entry.name,
                            copy_function=os.symlink,
                            ignore=shutil.ignore_patterns('__pycache__'))
    (scratch / 'build').mkdir()
    for name in ('bin', 'lib', 'python', 'npm', 'CMakeCache.txt'):
        if (build / name).exists():
            (scratch / 'build' / name).symlink_to(build / name)
    stand_ins = scratch / '.stand_ins'
    stand_ins.mkdir()
    cmake = CMAKE.replace('@CMAKE@', shutil.which('cmake'))
    (stand_ins / 'cmake').write_text(cmake.replace('@BUILD@', str(build)))
    (stand_ins / 'cmake').chmod(0o755)
    installs = scratch / 'scripts' / 'install_dependencies'
    installs.unlink()
    installs.write_text('#!/usr/bin/env bash\n')
    installs.chmod(0o755)
    return stand_ins


def main():
    source, build = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
    page_name = sys.argv[3]
    page = (source / page_name).read_text().splitlines()
    run_slow = sys.argv[4:] == ['--slow']
    exceptions = {command: instead for command, instead
                  in docs_exceptions.EXCEPTIONS.get(page_name, {}).items()
                  if not (run_slow and instead.is_slow)}
    # The places where cmake looks for it (cmake/ReportAssets.cmake).
    if ('rgbd_report' in '\n'.join(page) and
            not any((folder / 'npm' / 'node_modules').exists()
                    for folder in (build, source / 'build'))):
        print('skipped: built without plotly.js, which report pages need')
        sys.exit(SKIPPED)
    text, count = script(page_name, page, exceptions)
    if count == 0:
        print('no commands')
        return
    with tempfile.TemporaryDirectory(prefix='docs_') as folder:
        scratch = pathlib.Path(folder)
        stand_ins = make_checkout(source, build, scratch)
        path = os.pathsep.join(
            [str(stand_ins), str(scratch / 'build' / 'bin'),
             os.environ['PATH']])
        environment = dict(os.environ, PATH=path, HOME=str(scratch))
        before = docs_exceptions.BEFORE.get(page_name, '')
        for step in 'set -euo pipefail\n' + before, text:
            file = scratch / '.stand_ins' / 'page.sh'
            file.write_text(step)
            result = subprocess.run(['bash', str(file)], cwd=scratch,
                                    env=environment, timeout=TIMEOUT,
                                    stdin=subprocess.DEVNULL)
            if result.returncode != 0:
                sys.exit(f'{page_name}: exit code {result.returncode}')
    print(f'{page_name}: {count} commands, {len(exceptions)} of them excepted')


if __name__ == '__main__':
    main()
