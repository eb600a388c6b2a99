// Opens the page of a gallery in a real browser, clicks on pictures, and prints what was seen as JSON.
// node galleried.mjs ADDRESS PICTURE
import { launch, open } from '../../scripts/engines/chromium.mjs';

const [address, picture] = process.argv.slice(2);
const found = { complaints: [], shown: [] };
const browser = await launch();
try {
  const page = await open(browser, address, found.complaints);
  found.names = await page.locator('article h2').allInnerTexts();
  const images = await page.locator('article img').all();
  for (const image of images) await image.scrollIntoViewIfNeeded();
  await page.waitForFunction(() => [...document.images].every((image) => image.complete));
  found.pictures = await page.evaluate(() => [...document.images].map((image) => image.naturalWidth));
  found.viewer = (await page.locator('script').count()) > 0;
  if (found.viewer) {
    await page.waitForFunction(() => document.body.dataset.ready === 'true');
    for (const image of images.slice(0, 2)) {
      await image.click();
      const model = await image.evaluate((one) => one.closest('article').dataset.model);
      await page.waitForFunction((model) => {
        const marks = performance.getEntriesByName('kiln-drawn');
        return document.body.dataset.shown === model && marks.at(-1)?.detail === model;
      }, model);
      await page.locator('.stage').screenshot({ path: picture });
      found.shown.push(model);
    }
  }
} finally {
  await browser.close();
}
console.log(JSON.stringify(found));
