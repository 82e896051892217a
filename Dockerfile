# An image that runs studies:   docker build -t rockcli . && docker run --rm -v "$PWD":/work rockcli run study.yaml
# The first stage compiles kernels and makes the wheel; the second holds what a run needs, nothing that compiles.
FROM python:3.12-slim-bookworm AS wheel
WORKDIR /source
COPY . .
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels .

FROM python:3.12-slim-bookworm
# CalculiX for `model: continuum`; BLAS and LAPACK for OpenSeesPy: what .ci/run installs
RUN apt-get update \
 && apt-get install -y --no-install-recommends calculix-ccx libblas3 liblapack3 \
 && rm -rf /var/lib/apt/lists/*
COPY --from=wheel /wheels /wheels
RUN pip install --no-cache-dir "$(ls /wheels/rockcli-*.whl)[all]" && rm -rf /wheels
# results belong to whoever owns the folder: docker run --user "$(id -u):$(id -g)"
ENV MPLCONFIGDIR=/tmp/matplotlib ROCK_CACHE_DIR=/tmp/rockcli
RUN useradd --create-home rock
USER rock
RUN cd /tmp && rock new block && ROCK_KERNELS=ahead rock run block.yaml --out /tmp/first --workers 1 && rm -rf /tmp/first /tmp/block.yaml
WORKDIR /work
ENTRYPOINT ["rock"]
CMD ["--help"]
