"""The last pieces of the script: the time loop with impacts, and what it writes."""

from __future__ import annotations

TOP_RIGID = """\
def top():
    \"\"\"Horizontal and vertical displacement of the body's top, and the part of the former due to bending [m].\"\"\"
    return z_top * math.sin(theta), -z_top * (1.0 - math.cos(theta)), 0.0


def rigid_part():
    \"\"\"Rotation and rate of the body as a whole.\"\"\"
    return theta, theta_dot
"""

TOP_FLEXIBLE = """\
def top():
    \"\"\"Horizontal and vertical displacement of the top, and the part of the former due to bending [m].\"\"\"
    u = ops.nodeDisp(TOP, 1)
    return u, ops.nodeDisp(TOP, 2), u - z_top * math.sin(theta)


def rigid_part():
    \"\"\"Rotation and rate of the body as a whole, from where its mass is and how it turns: no vibration in them.\"\"\"
    x = y = turning = about = 0.0
    for i, height in enumerate(heights):
        u, v, u_dot, v_dot = (f(BASE + i, dof) for f in (ops.nodeDisp, ops.nodeVel) for dof in (1, 2))
        x += weights[i] * height * u
        y += weights[i] * height * (height + v)
        turning += weights[i] * ((height + v) * u_dot - u * v_dot) - rotary[i] * ops.nodeVel(BASE + i, 3)
        about += weights[i] * height**2 + rotary[i]
    return math.atan2(x, y), turning / about
"""

ADVANCE = """\
smallest = DT
divided = 0  # steps that had to be divided
iterations = 0  # of Newton, those of divided steps too


def advance(dt):
    \"\"\"One step.  Newton may cycle between the two branches of the spring's kink: then ten steps of a tenth.\"\"\"
    global smallest, divided, iterations
    failed = ops.analyze(1, dt)
    iterations += ops.testIter()
    if failed == 0:
        smallest = min(smallest, dt)
        return
    if dt < DT / 1e6:
        sys.exit(f"no convergence at t = {ops.getTime():.6g} s, not even with a step of {dt:.1e} s")
    divided += 1
    for _ in range(10):
        advance(dt / 10.0)


theta, theta_dot, t = theta_0, theta_dot_0, 0.0
armed = abs(theta) > theta_armed  # whether coming back to theta = 0 is an impact
last_armed = 0.0
"""

UPLIFTED = {
    False: "t_uplift = 0.0 if theta != 0.0 or theta_dot != 0.0 else None\n",
    True: "t_uplift = 0.0 if opened() else None  # such a base turns in full contact too\n",
}
"""Whether the body begins uplifted, by whether its base yields."""

LOOP = """\
peak = {"theta": theta, "t": 0.0, "theta_dot": abs(theta_dot), "u_top": abs(top()[0])}
impacts = []  # t, theta_dot before, theta_dot after
rows = [(t, theta, theta_dot, *top(), base_moment())]
ended = "end"
i = 0
while i < STEPS:
    # where the base is about to close, small steps: crossing the kink in one leap errs in energy
    closing = armed and abs(theta) < 2.0 * abs(theta_dot) * DT
    parts = FINE if closing else 1
    for _ in range(parts):
        before = theta
        advance(DT / parts)
        theta, theta_dot = -ops.nodeDisp(BASE, 3), -ops.nodeVel(BASE, 3)
        if armed and before * theta <= 0.0:  # the base has closed
            eta = eta_left if theta < 0.0 else eta_right
            impacts.append((ops.getTime(), theta_dot, eta * theta_dot))
            armed = False
            if eta != 1.0:
                for node in range(BASE, TOP + 1):
                    for dof in (1, 2, 3):
                        ops.setNodeVel(node, dof, eta * ops.nodeVel(node, dof), "-commit")
                ops.domainChange()  # without it the integrator goes on with its own velocities
                theta_dot *= eta
    i += 1
    t = i * DT
    if not math.isfinite(theta):
        sys.exit(f"the solution ceased to be finite at t = {t:.6g} s")
    if abs(theta) > theta_armed:  # one eta per impact: the base has to open by this much before the next
        armed, last_armed = True, t
    if t_uplift is None and opened():
        t_uplift = t
    if abs(theta) > abs(peak["theta"]):
        peak["theta"], peak["t"] = theta, t
    peak["theta_dot"] = max(peak["theta_dot"], abs(theta_dot))
    peak["u_top"] = max(peak["u_top"], abs(top()[0]))
    if i == 1:  # OpenSees knows the moment only after a step
        rows[0] = (*rows[0][:-1], base_moment())
    if i % EVERY == 0 or i == STEPS:
        rows.append((t, theta, theta_dot, *top(), base_moment()))
    if abs(theta) > 0.5 * math.pi:
        ended = "overturned"
        break
    if t - max(last_armed, T_MOTION) > T_REST:
        ended = "rest"
        break
if rows[-1][0] != t:
    rows.append((t, theta, theta_dot, *top(), base_moment()))
"""

WRITE = """\
# ---------------------------------------------------------------- results
with open(RESULTS, "w") as file:
    file.write("# t [s], theta [rad], theta_dot [rad/s], u_top [m], v_top [m], u_top_bending [m], M_base [N m]\\n")
    for row in rows:
        file.write(" ".join(f"{x:.17g}" for x in row) + "\\n")
summary = {
    "ended": ended,
    "t_end": max(last_armed, T_MOTION) if ended == "rest" else min(t, T_STOP),
    "theta": theta,
    "theta_dot": theta_dot,
    "rigid_part": rigid_part(),
    "theta_peak": peak["theta"],
    "t_peak": peak["t"],
    "theta_dot_peak": peak["theta_dot"],
    "u_top_peak": peak["u_top"],
    "t_uplift": t_uplift,
    "impacts": impacts,
    "steps": i,
    "iterations": iterations,
    "divided_steps": divided,
    "smallest_step": smallest,
}
with open(SUMMARY, "w") as file:
    json.dump(summary, file, indent=1)
print(f"{ended} at t = {t:.4f} s; peak theta/alpha {peak['theta'] / alpha:.6f} at {peak['t']:.4f} s; "
      f"{len(impacts)} impacts")
"""
