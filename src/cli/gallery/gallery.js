// Opens the viewer where a picture is clicked; one at a time, for browsers have few contexts of WebGL.
import { Viewer } from './viewer.js';

const stage = document.createElement('div');
stage.className = 'stage';
let viewer = null;

async function open(article) {
  article.querySelector('.view').append(stage);
  viewer ??= new Viewer(stage, () => {});
  const address = article.dataset.model;
  viewer.forget();
  await viewer.load({ key: address, address });
  document.body.dataset.shown = address;
}

for (const article of document.querySelectorAll('article')) {
  const image = article.querySelector('img');
  image.tabIndex = 0;
  image.addEventListener('click', () => open(article));
  image.addEventListener('keydown', (event) => { if (event.key === 'Enter') open(article); });
}
document.body.dataset.ready = 'true';
