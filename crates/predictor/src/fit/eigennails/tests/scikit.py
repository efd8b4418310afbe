"""What scikit-learn gives on small matrices, for the tests of eigennails: writes scikit.json beside itself.

    pip install scikit-learn==1.9.1
    python scikit.py
"""

import json
import pathlib

import numpy as np
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.linear_model import Ridge
from sklearn.model_selection import LeaveOneGroupOut, cross_val_predict

random = np.random.default_rng(20)
x = random.standard_normal((40, 4)).round(6)
y = np.column_stack([np.sin(x[:, 0]) + 0.3 * x[:, 1], x[:, 2] * x[:, 0] - 2.0]) + 0.05 * random.standard_normal((40, 2))
y = y.round(6)
at = random.standard_normal((6, 4)).round(6)
groups = np.arange(40) // 8
label = (x[:, 0] + 0.4 * random.standard_normal(40) > 0).astype(int) + (x[:, 1] > 0.8)

ridge = []
for alpha in (1e-6, 0.1, 30.0):
    model = Ridge(alpha=alpha).fit(x, y)
    left_out = cross_val_predict(Ridge(alpha=alpha), x, y, groups=groups, cv=LeaveOneGroupOut())
    ridge.append(
        {
            "alpha": alpha,
            "coefficients": model.coef_.tolist(),
            "offset": model.intercept_.tolist(),
            "left_out": left_out.tolist(),
        }
    )

process = []
for amplitude, length, noise in ((0.7, 1.5, 0.01), (2.0, 3.0, 1e-4), (1.0, 0.4, 0.5)):
    kernel = ConstantKernel(amplitude**2) * RBF(length) + WhiteKernel(noise * amplitude**2)
    # One target at a time, about the mean of its rows.
    means, sds, likelihoods = [], [], []
    for k in range(2):
        centre = y[:, k].mean()
        model = GaussianProcessRegressor(kernel, alpha=0.0, optimizer=None).fit(x, y[:, k] - centre)
        mean, sd = model.predict(at, return_std=True)
        means.append((mean + centre).tolist())
        sds.append(sd.tolist())
        likelihoods.append(model.log_marginal_likelihood_value_)
    process.append(
        {"amplitude": amplitude, "length": length, "noise": noise, "means": means, "sds": sds, "likelihoods": likelihoods}
    )

lda = LinearDiscriminantAnalysis(solver="lsqr").fit(x, label)
out = {
    "x": x.tolist(),
    "y": y.tolist(),
    "at": at.tolist(),
    "groups": groups.tolist(),
    "labels": label.tolist(),
    "ridge": ridge,
    "process": process,
    "log_shares": lda.predict_log_proba(at).tolist(),
}
path = pathlib.Path(__file__).with_name("scikit.json")
path.write_text(json.dumps(out, indent=1) + "\n")
