// A real browser for tests of pages: Debian's Chromium, drawing without a graphics card.
import { createRequire } from 'node:module';

const { chromium } = createRequire(new URL('../package.json', import.meta.url))('playwright-core');

const ARGUMENTS = [
  '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage',
  '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
];

export function launch() {
  return chromium.launch({ executablePath: '/usr/bin/chromium', headless: true, args: ARGUMENTS });
}

// Opens a page; what its console complains of is added to a list.
export async function open(browser, address, complaints) {
  const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
  page.on('console', (one) => {
    if (['error', 'warning'].includes(one.type())) complaints.push(`${one.type()}: ${one.text()}`);
  });
  page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
  await page.goto(address);
  return page;
}
