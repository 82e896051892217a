"""How the HTML report looks: one column, readable on a laptop and on paper."""

CSS = """\
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #f4f4f2; color: #1c1c1c; font: 15px/1.5 system-ui, "Segoe UI", sans-serif; }
main { max-width: 1060px; margin: 0 auto; padding: 24px 32px 64px; }
header { margin: 8px 0 20px; }
h1 { font-size: 26px; line-height: 1.25; margin: 0 0 6px; }
h2 { font-size: 18px; margin: 0 0 10px; }
h3 { font-size: 15px; margin: 18px 0 6px; }
p { margin: 0 0 8px; }
section { background: #fff; border: 1px solid #e2e2de; border-radius: 6px; padding: 18px 22px; margin: 0 0 16px; }
.quiet { color: #666; margin: 0 0 6px; }
.bar { display: flex; height: 18px; border-radius: 3px; overflow: hidden; margin: 6px 0; max-width: 640px; }
ul { margin: 0; padding: 0; list-style: none; }
.key li { display: inline-block; margin: 0 18px 0 0; }
.key i { display: inline-block; width: 11px; height: 11px; margin-right: 6px; border: 1px solid #0002; }
.verdicts li, .notes li { padding: 3px 0 3px 12px; border-left: 3px solid #bbb; margin: 4px 0; }
.verdicts .ok { border-color: #009e73; }
.verdicts .bad { border-color: #d55e00; background: #fdf1ea; }
.verdicts b { display: inline-block; min-width: 4.5em; font-weight: 600; }
.plot { overflow-x: auto; text-align: center; }
.plot img { max-width: 100%; height: auto; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13.5px; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 14px 4px 0; text-align: left; vertical-align: top; border-bottom: 1px solid #eee; }
thead th { border-bottom: 1px solid #999; vertical-align: bottom; }
.facts th { font-weight: 500; color: #555; white-space: nowrap; }
.facts td { overflow-wrap: anywhere; }
pre { margin: 0; font: 13px/1.45 ui-monospace, Menlo, Consolas, monospace; white-space: pre-wrap; }
@media print { body { background: #fff; } section { border: 0; padding: 0; break-inside: avoid; } }
"""
