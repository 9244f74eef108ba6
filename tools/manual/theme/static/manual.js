// GPL-2.0-or-later. The manual: light and dark, and the heading that is being read.

const kThemes = ['auto', 'light', 'dark'];

const kSystemIsDark = window.matchMedia('(prefers-color-scheme: dark)');
let chosen = 'auto';

/** Shows the theme that was chosen, which may be that of the system. */
function show() {
    const isDark = chosen === 'auto' ? kSystemIsDark.matches : chosen === 'dark';
    document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
    document.getElementById('dark-code').media = isDark ? 'all' : 'not all';
}

// Browsers may keep nothing for pages that are files: then each page begins with the theme of the system.
try {
    chosen = localStorage.getItem('theme') ?? 'auto';
} catch {}
kSystemIsDark.addEventListener('change', show);
show();

document.addEventListener('DOMContentLoaded', () => {
    document.getElementById('theme').addEventListener('click', () => {
        chosen = kThemes[(kThemes.indexOf(chosen) + 1) % kThemes.length];
        show();
        try {
            localStorage.setItem('theme', chosen);
        } catch {}
    });
    const links = [...document.querySelectorAll('nav.headings a')];
    const headings = links.map((link) => document.getElementById(decodeURIComponent(link.hash.slice(1))));
    /** Marks the last heading above the upper third of the window. */
    const mark = () => {
        let current = 0;
        headings.forEach((heading, i) => {
            if (heading && heading.getBoundingClientRect().top < window.innerHeight / 3) {
                current = i;
            }
        });
        links.forEach((link, i) => link.classList.toggle('current', i === current));
        links[current]?.scrollIntoView({ block: 'nearest' });
    };
    if (links.length) {
        window.addEventListener('scroll', mark, { passive: true });
        mark();
    }
});
