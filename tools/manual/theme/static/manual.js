// GPL-2.0-or-later. The manual: light and dark, and the heading that is being read.

const kThemes = ['auto', 'light', 'dark'];

/** Shows the theme: that of the system, or one that was chosen. */
function show(theme) {
    document.documentElement.dataset.theme = theme;
    const code = document.getElementById('dark-code');
    if (code) {
        code.media = theme === 'auto' ? '(prefers-color-scheme: dark)' : theme === 'dark' ? 'all' : 'not all';
    }
}

/** Browsers may keep nothing for pages that are files. */
function kept() {
    try {
        return localStorage.getItem('theme') || 'auto';
    } catch {
        return 'auto';
    }
}

function keep(theme) {
    try {
        localStorage.setItem('theme', theme);
    } catch {
        // It is shown, and the next page shows that of the system.
    }
}

show(kept());

document.addEventListener('DOMContentLoaded', () => {
    document.getElementById('theme').addEventListener('click', () => {
        const theme = kThemes[(kThemes.indexOf(document.documentElement.dataset.theme) + 1) % kThemes.length];
        show(theme);
        keep(theme);
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
