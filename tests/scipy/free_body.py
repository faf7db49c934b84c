"""Solves the free body by SciPy's RK45 and DOP853, writes both in our columns, and says what errors they have against
DOP853 at 3e-14, which is good to 1e-13 rad.

  free_body.py '[inertia, q0, omega0]' POINTS      writes RK45.csv, DOP853.csv and expected.json

RK45.csv and DOP853.csv in this folder: SciPy 1.10.1, NumPy 1.24.2, the defaults of free_body, 51 points, one for each
state of its certified reference:
  free_body.py '[[100.0, 120.0, 110.0], [0.227, 0.383, 0.227, 0.866], [0.17453292519943295, 0.17453292519943295, 0.17453292519943295]]' 51
"""
import json, sys
import numpy as np
from scipy.integrate import solve_ivp

J, q0, w0 = (np.array(x) for x in json.loads(sys.argv[1]))
q0 /= np.linalg.norm(q0)

def field(t, y):
    (x, yy, z, s), w = y[:4], y[4:]
    q = 0.5 * np.array([s*w[0] + yy*w[2] - z*w[1], s*w[1] + z*w[0] - x*w[2], s*w[2] + x*w[1] - yy*w[0],
                        -x*w[0] - yy*w[1] - z*w[2]])
    return np.concatenate([q, np.cross(J*w, w)/J])

def angle(p, q):
    v = p[3]*q[:3] - q[3]*p[:3] - np.cross(p[:3], q[:3])
    return 2*np.arctan2(np.linalg.norm(v), abs(p @ q))

t = np.linspace(0, 50, int(sys.argv[2]))
def solve(method, rtol):
    return solve_ivp(field, (0, 50), np.concatenate([q0, w0]), method, t, rtol=rtol, atol=rtol/100).y.T
tight = solve("DOP853", 3e-14)
largest = max(np.linalg.norm(y[4:]) for y in tight)
expected = {}
for method, rtol in [("RK45", 1e-6), ("DOP853", 1e-8)]:
    y = solve(method, rtol)
    np.savetxt(method + ".csv", np.column_stack([t, y]), "%+.17e", ",", header="t,q1,q2,q3,q4,wx,wy,wz", comments="")
    energy = 0.5*np.sum(J*y[:, 4:]**2, 1)
    momentum = np.linalg.norm(J*y[:, 4:], axis=1)
    angles = [angle(a[:4], b[:4]) for a, b in zip(tight, y)]
    expected[method] = {
        "attitude_error_max": max(angles), "attitude_error_end": angles[-1],
        "rate_error_max": max(np.linalg.norm(a[4:] - b[4:]) for a, b in zip(tight, y))/largest,
        "norm_drift_max": np.max(np.abs(np.sum(y[:, :4]**2, 1) - 1)),
        "energy_drift_max": np.max(np.abs(energy/energy[0] - 1)),
        "momentum_drift_max": np.max(np.abs(momentum/momentum[0] - 1))}
json.dump(expected, open("expected.json", "w"))
