#!/usr/bin/env python3
"""Checks README.md, CONTRIBUTING.md and docs/: docs_pages.py SOURCE

- Links lead to existing files of the project and to existing headings.
- Every page of docs/ can be reached from README.md and is in docs/README.md.
- A ```cpp block equals the file named in the comment before it
  (<!-- docs/examples/x.cc -->), which a test compiles and runs. This applies to
  any other block with such a comment. With --write, blocks are updated instead.
- Names that a flag takes are in the table of the page about them.
- Blocks have a language that is tested: sh is run by
  tests/docs/docs_commands.py, python by tests/python/test_docs.py.
"""

import pathlib
import re
import sys

import docs_exceptions

# Pages whose blocks are compiled unchanged, by tests/CMakeLists.txt.
COMPILED = ['docs/compressed_block.md']
LANGUAGES = ['cpp', 'diff', 'python', 'sh', 'text']

# Flags that take names, and the page with a table of these.
NAMES = {'direct_cost': 'docs/direct.md', 'frontend': 'docs/frontends.md',
         'source': 'docs/sources.md', 'to': 'docs/exports.md',
         'tracker': 'docs/frontends.md'}

BLOCK = re.compile(r'(<!-- (docs/examples/\S+) -->\n)?```(\w*)\n(.*?)```', re.S)


def without_blocks(text):
    return re.sub(r'```.*?```', '', text, flags=re.S)


def anchors(text):
    """The anchors of a page's headings, as used in links."""
    names = set()
    for heading in re.findall(r'^#+ (.*)$', without_blocks(text), re.M):
        heading = re.sub(r'\[([^]]*)\]\([^)]*\)', r'\1', heading).lower()
        names.add(re.sub(r'[^\w\- ]', '', heading).replace(' ', '-'))
    return names


def check_links(source, pages):
    problems = []
    reached = {'README.md'}
    for name, text in pages.items():
        folder = (source / name).parent
        for target in re.findall(r'\]\(([^)\s]+)\)', without_blocks(text)):
            if re.match(r'https?://', target):
                continue
            path, _, anchor = target.partition('#')
            file = (folder / path).resolve() if path else source / name
            if not file.exists():
                problems.append(f'{name}: no such file: {target}')
                continue
            linked = file.relative_to(source).as_posix()
            reached.add(linked)
            if anchor and anchor not in anchors(file.read_text()):
                problems.append(f'{name}: no such heading: {target}')
    problems += [f'{name}: no page links to it'
                 for name in sorted(set(pages) - reached)]
    index = re.findall(r'\]\(([^)#]+)\)', pages.get('docs/README.md', ''))
    problems += [f'docs/README.md: does not list {name}' for name in sorted(pages)
                 if name.startswith('docs/') and name != 'docs/README.md' and
                 name[len('docs/'):] not in index]
    return problems


def check_names(pages):
    problems = []
    flags = pages['docs/reference/flags.md']
    for flag, page in NAMES.items():
        choices = re.search(rf'^\| `--{flag}` .*one of ([^|]*)\|', flags, re.M)
        rows = ' '.join(re.findall(r'^\| (`[^|]*)\|', pages[page], re.M))
        problems += [f'{page}: no row of {name} (--{flag})'
                     for name in re.findall(r'`\w+`', choices.group(1))
                     if name not in rows and name != '`auto`']
    return problems


def check_blocks(source, name, text, write):
    """Returns the problems and the page with updated examples."""
    problems = []

    def renew(match):
        comment, example, language, content = match.groups()
        if language not in LANGUAGES:
            problems.append(f'{name}: a block must be one of {LANGUAGES}, not '
                            f'"{language}": {content.splitlines()[0]}')
        if (language != 'cpp' and not example) or name in COMPILED:
            return match.group()
        if not example:
            problems.append(f'{name}: a cpp block without the name of its file')
            return match.group()
        if not (source / example).exists():
            problems.append(f'{name}: no such file: {example}')
            return match.group()
        code = (source / example).read_text()
        if content != code and not write:
            problems.append(f'{name}: differs from {example}; '
                            'tests/docs/docs_pages.py . --write renews it')
        return f'{comment}```{language}\n{code}```'

    return problems, BLOCK.sub(renew, text)


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    write = '--write' in sys.argv[2:]
    paths = [source / 'README.md', source / 'CONTRIBUTING.md']
    paths += sorted((source / 'docs').rglob('*.md'))
    pages = {path.relative_to(source).as_posix(): path.read_text()
             for path in paths}
    problems = check_links(source, pages) + check_names(pages)
    examples = set()
    for name, text in pages.items():
        more, renewed = check_blocks(source, name, text, write)
        problems += more
        examples |= set(re.findall(r'docs/examples/[a-z_]+\.\w+', text))
        if write and renewed != text:
            (source / name).write_text(renewed)
    problems += [f'tests/docs/docs_exceptions.py: there is no page {name}'
                 for name in {**docs_exceptions.EXCEPTIONS,
                              **docs_exceptions.BEFORE} if name not in pages]
    problems += [f'{path.name}: no page mentions docs/examples/{path.name}'
                 for path in sorted((source / 'docs/examples').glob('*.[cip]*'))
                 if f'docs/examples/{path.name}' not in examples]
    if problems:
        sys.exit('\n'.join(problems))
    print(f'{len(pages)} pages')


if __name__ == '__main__':
    main()
