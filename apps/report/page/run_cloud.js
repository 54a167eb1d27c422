'use strict';

// What the camera saw: a few points of the cloud, beside the path in 3D.

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), character => character.charCodeAt(0));
}

function cloudTraces(data) {
  const cloud = data.cloud;
  if (!cloud || cloud.points === 0) return [];
  const steps = new DataView(bytesOf(cloud.positions).buffer);
  const color = bytesOf(cloud.colors);
  const place = (point, k) =>
      cloud.origin_m[k] + cloud.step_m * steps.getUint16(6 * point + 2 * k, true);
  const each = [...Array(cloud.points).keys()];
  return [{
    type: 'scatter3d', mode: 'markers', name: 'what was seen', hoverinfo: 'skip',
    x: each.map(i => place(i, 0)), y: each.map(i => place(i, 1)),
    z: each.map(i => place(i, 2)),
    marker: {size: 2, color: each.map(
        i => `rgb(${color[3 * i]},${color[3 * i + 1]},${color[3 * i + 2]})`)},
  }];
}

function cloudNote(data, element) {
  const all = data.metrics.cloud;
  if (!all) return;
  const number = count => count.toLocaleString('en');
  element.append(make('p', {class: 'soft caption screen', id: 'cloud-note'}, data.cloud
      ? `What was seen: ${number(data.cloud.points)} of the ` +
        `${number(all.points)} points of ${setting(data, 'save_cloud')}, from ` +
        `${all.frames} frame${all.frames === 1 ? '' : 's'}. A click on its name hides it.`
      : 'The points of what was seen are not shown: this run has no ' +
        'cloud_preview.json; repeat it with this version.'));
}
