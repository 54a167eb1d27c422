'use strict';

// What the camera saw: a thinned mesh or some points of the cloud, with the
// path in 3D.

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), character => character.charCodeAt(0));
}

function wordsOf(base64) {
  const view = new DataView(bytesOf(base64).buffer);
  return Array.from({length: view.byteLength / 2}, (_, i) => view.getUint16(2 * i, true));
}

// Coordinates and colours of the points of a preview, which is in the world of
// the trajectory.
function previewPoints(preview, data) {
  const move = truthFromMap(data);
  const steps = wordsOf(preview.positions), color = bytesOf(preview.colors);
  const points = [...Array(preview.points).keys()].map(i => move([0, 1, 2].map(
      k => preview.origin_m[k] + preview.step_m * steps[3 * i + k])));
  return {
    x: points.map(p => p[0]), y: points.map(p => p[1]), z: points.map(p => p[2]),
    colors: points.map((_, i) =>
        `rgb(${color[3 * i]},${color[3 * i + 1]},${color[3 * i + 2]})`),
  };
}

function cloudTraces(data) {
  const cloud = data.cloud;
  if (!cloud || cloud.points === 0) return [];
  const {x, y, z, colors} = previewPoints(cloud, data);
  return [{
    type: 'scatter3d', mode: 'markers', name: 'point cloud', hoverinfo: 'skip',
    x, y, z, marker: {size: 2, color: colors},
  }];
}

function meshTraces(data) {
  const mesh = data.mesh;
  const {x, y, z, colors} = previewPoints(mesh, data);
  const corners = wordsOf(mesh.corners);
  const at = k => corners.filter((_, i) => i % 3 === k);
  return [{
    type: 'mesh3d', name: 'mesh', hoverinfo: 'skip', showlegend: true,
    x, y, z, i: at(0), j: at(1), k: at(2), vertexcolor: colors,
    // The vertex colours already include lighting.
    lighting: {ambient: 1, diffuse: 0, specular: 0, fresnel: 0},
    lightposition: {x: 0, y: 0, z: 0},
  }];
}

function seenTraces(data) {
  return data.mesh && data.mesh.triangles ? meshTraces(data) : cloudTraces(data);
}

function seenNote(data, element) {
  const number = count => count.toLocaleString('en');
  const frames = count => `${number(count)} frame${count === 1 ? '' : 's'}`;
  const note = text => element.append(
      make('p', {class: 'soft caption screen', id: 'cloud-note'}, text));
  const seen = data.mesh || data.cloud;
  if (!seen) return;
  const [name, shown, what] = data.mesh
      ? ['Mesh', seen.triangles, 'triangles'] : ['Point cloud', seen.points, 'points'];
  note(`${name}: ${number(shown)} of the ${number(seen.all)} ${what} of ` +
       `${seen.file}, from ${frames(seen.frames)}. A click on its name hides it.`);
}
