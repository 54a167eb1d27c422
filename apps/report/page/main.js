'use strict';

const PAGES = {
  run: showRun, batch: showBatch, comparison: showComparison, sweep: showSweep,
  calibration: showCalibration,
};
const page = document.getElementById('page');
PAGES[page.dataset.kind](JSON.parse(document.getElementById('data').textContent));
fitForPrint();
page.dataset.done = 'true';
