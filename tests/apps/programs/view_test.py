"""The live page of rgbd_slam in a real browser, while it tracks.

usage: view_test.py BIN_FOLDER [IMAGE]

A camera moves around a table: the path grows on two pages, a pause works, a
reloaded page shows the whole run, a loop and the end are shown, and the results
have the same bytes as without --view. Then the stop button is tested. IMAGE: a
file for a picture of the page. The exit code is 77 (test skipped) without
chromium or where the programs have no --view.
"""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

BIN = sys.argv[1]
PATIENCE = 120  # s
CAMERA = ('Camera.fx: 262.5\nCamera.fy: 262.5\nCamera.cx: 159.5\n'
          'Camera.cy: 119.5\nCamera.width: 320\nCamera.height: 240\n')
# Once around the table in 60 s.
FRAMES = 300
RATE = 5


def program(name):
    return os.path.join(BIN, name)


def check(condition, *what):
    if not condition:
        sys.exit('FAILED: ' + ' '.join(str(word) for word in what))


class Browser:
    """A headless chromium that is controlled through a pipe (DevTools)."""

    def __init__(self, folder):
        to_browser, self.commands = os.pipe()
        self.answers, from_browser = os.pipe()

        def connect():  # chromium reads from 3 and writes to 4
            os.dup2(os.dup(to_browser), 3)
            os.dup2(os.dup(from_browser), 4)

        self.process = subprocess.Popen(
            ['chromium', '--headless', '--no-sandbox', '--disable-gpu',
             '--disable-quic', '--no-first-run', '--disable-background-networking',
             '--disable-component-update', '--disable-sync',
             '--remote-debugging-pipe', '--user-data-dir=' + folder],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            close_fds=False, preexec_fn=connect)
        os.close(to_browser)
        os.close(from_browser)
        self.count = 0
        self.rest = b''
        self.complaints = []

    def call(self, method, session=None, **parameters):
        self.count += 1
        message = {'id': self.count, 'method': method, 'params': parameters}
        if session:
            message['sessionId'] = session
        os.write(self.commands, json.dumps(message).encode() + b'\0')
        while True:
            while b'\0' not in self.rest:
                part = os.read(self.answers, 1 << 20)
                check(part, 'the browser has ended')
                self.rest += part
            text, self.rest = self.rest.split(b'\0', 1)
            answer = json.loads(text)
            if answer.get('method') in ('Runtime.exceptionThrown', 'Log.entryAdded'):
                self.complaints.append(answer['params'])
            if answer.get('id') == self.count:
                check('error' not in answer, method, answer)
                return answer['result']

    def close(self):
        self.process.terminate()
        self.process.wait()


class Page:
    def __init__(self, browser, address):
        self.browser = browser
        target = browser.call('Target.createTarget', url='about:blank')
        self.session = browser.call('Target.attachToTarget', flatten=True,
                                    targetId=target['targetId'])['sessionId']
        self.call('Runtime.enable')
        self.call('Page.enable')
        self.call('Emulation.setDeviceMetricsOverride', width=1440, height=1180,
                  deviceScaleFactor=1, mobile=False)
        self.call('Page.navigate', url=address)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def ask(self, script):
        result = self.call('Runtime.evaluate', expression=script,
                           returnByValue=True)
        check('exceptionDetails' not in result, script, result)
        return result['result'].get('value')

    def data(self, name):
        return self.ask(f'document.getElementById("page")?.dataset.{name}')

    def frames(self):
        return int(self.data('frames') or 0)

    def text(self, element):
        return self.ask(f'document.getElementById("{element}").textContent')

    def press(self, element):
        self.ask(f'document.getElementById("{element}").click()')

    def wait_for(self, what, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            check(time.monotonic() < end, 'waited in vain for', what)
            time.sleep(0.05)

    def picture(self, path):
        with open(path, 'wb') as file:
            file.write(base64.b64decode(
                self.call('Page.captureScreenshot', format='png')['data']))


def slam(folder, output, *flags):
    return subprocess.Popen(
        [program('rgbd_slam'), f'--dataset={folder}/table',
         f'--camera={folder}/table/camera.yaml', f'--output={folder}/{output}',
         '--noreport', *flags],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def address_of(run):
    for line in run.stderr:
        if line.startswith('view on '):
            return line.split()[-1]
    sys.exit('FAILED: no address')


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


def poses(text):
    return [line for line in text.splitlines() if not line.startswith('#')]


def watch_a_run(folder, browser, picture):
    run = slam(folder, 'seen', '--view', '--view_speed=6')
    address = address_of(run)
    page, other = Page(browser, address), Page(browser, address)
    for each in (page, other):
        each.wait_for('frames', lambda each=each: each.frames() > 20)
        each.wait_for('images', lambda each=each: each.data('images') == 'true')
    seen = page.frames()
    page.wait_for('a longer path', lambda: page.frames() > seen)
    check(page.ask('map.path().filter(step => step.p).length') > 20, 'no path')
    page.call('Page.bringToFront')  # only the page in front is drawn
    page.wait_for('points', lambda: page.ask('new Set(scene.pixels).size') > 50)

    page.press('pause')
    for each in (page, other):
        each.wait_for('a pause', lambda each=each: each.data('paused') == 'true')
    time.sleep(0.5)  # lets pending frames arrive
    held = page.frames()
    time.sleep(0.5)
    check(page.frames() == held, 'a pause does not hold')
    check(held < FRAMES, 'paused after the end')
    page.call('Page.reload')
    page.wait_for('the same run again', lambda: page.frames() == held)
    check(page.data('paused') == 'true', 'a page loaded again does not know of the pause')
    check(page.text('pause') == 'Resume', page.text('pause'))
    page.press('pause')
    page.wait_for('what follows', lambda: page.frames() > held)

    page.wait_for('a loop', lambda: int(page.data('loops') or 0) > 0)
    page.wait_for('words on it', lambda: 'Loop closed' in page.text('notice'))
    if picture:
        time.sleep(0.4)
        page.picture(picture)
    for each in (page, other):
        each.wait_for('the end', lambda each=each: each.data('ended') == 'true')
        check(f'{folder}/seen' in each.text('reason'), each.text('reason'))
        check(each.frames() == FRAMES, each.frames(), 'frames')
        check(each.ask('document.getElementById("stop").disabled'), 'what to stop?')
    run.communicate()
    check(run.returncode == 0, 'exit code', run.returncode)

    plain = slam(folder, 'unseen')
    plain.communicate()
    for file in ('trajectory.txt', 'trajectory_online.txt', 'edges.csv',
                 'keyframes.csv', 'graph.g2o'):
        check(read(folder, 'seen', file) == read(folder, 'unseen', file),
              file, 'is not the same with --view')


def stop_a_run(folder, browser):
    run = slam(folder, 'stopped', '--view', '--view_speed=1')
    page = Page(browser, address_of(run))
    page.wait_for('frames', lambda: page.frames() > 3)
    page.press('pause')  # a stop also ends a pause
    page.wait_for('a pause', lambda: page.data('paused') == 'true')
    page.press('stop')
    page.wait_for('the end', lambda: page.data('ended') == 'true')
    said = run.communicate()[1]
    check(run.returncode == 6, 'exit code', run.returncode)
    check('stop button of the live page' in said, said)
    kept = poses(read(folder, 'stopped', 'trajectory.txt'))
    whole = poses(read(folder, 'unseen', 'trajectory_online.txt'))
    check(3 < len(kept) < len(whole), len(kept), 'poses of', len(whole))


def main():
    if not shutil.which('chromium'):
        print('skipped: no chromium')
        sys.exit(77)
    # Children of the browser still write into its folder for a moment after it
    # has ended, so that the folder may not be empty when it is removed.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        with open(f'{folder}/half.yaml', 'w', encoding='utf-8') as file:
            file.write(CAMERA)
        subprocess.run(
            [program('rgbd_simulate'), '--scene=table', '--path=table',
             f'--camera={folder}/half.yaml', f'--frames={FRAMES}', f'--rate={RATE}',
             f'--output={folder}/table'], check=True, stdout=subprocess.DEVNULL)
        browser = Browser(folder + '/browser')
        try:
            watch_a_run(folder, browser, sys.argv[2] if len(sys.argv) > 2 else '')
            stop_a_run(folder, browser)
            check(not browser.complaints, browser.complaints)
        finally:
            browser.close()
    print('ok')


if __name__ == '__main__':
    main()
