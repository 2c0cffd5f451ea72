# SPDX-License-Identifier: Apache-2.0
"""Defines the networks that compute numbers from pictures, in floating point for training and in integers for deployment."""

import dataclasses

import torch
from torch import nn
from torch.nn import functional



@dataclasses.dataclass(frozen=True)
class Shape:
    """A network: convolutions as (input channels, output channels, kernel, stride, true if a pool by 2 follows), then a dense
    layer."""
    convolutions: tuple
    outputs: int

    @property
    def features(self):
        return 6 * 6 * self.convolutions[-1][1]


# The Stargate navigator with the camera as its only sensor. Its output is one yaw command.
NAVIGATOR = Shape(((1, 4, 5, 2, True),
                   (4, 4, 3, 2, False), (4, 4, 3, 1, False),
                   (4, 16, 3, 2, False), (16, 16, 3, 1, False),
                   (16, 32, 3, 2, False), (32, 32, 3, 1, False)), 1)
# The sight network. Its outputs are the position of the gate: yaw, rise, size, visible (sight.py). An inference has 1.7 times the
# navigator's multiplications.
SIGHT = Shape(((1, 8, 5, 2, True),
               (8, 8, 3, 2, False), (8, 8, 3, 1, False),
               (8, 16, 3, 2, False), (16, 16, 3, 1, False),
               (16, 32, 3, 2, False), (32, 32, 3, 1, False)), 4)
EDGE = 168
INPUT_STEP = 1.0 / 64       # real value of one grey level of the picture
ACTIVATION_STEP = 6.0 / 255  # real value of one count of an activation: ReLU6 is 0..255
OUTPUT_STEP = 1.0 / 127     # real value of one count of an output


class Navigator(nn.Module):
    """The network in floating point, with batch normalisation. The input is pictures in grey levels minus 128. Returns the
    outputs of each picture. If the network has one output, the result has only the dimension of the pictures."""

    def __init__(self, shape=NAVIGATOR):
        super().__init__()
        self.shape = shape
        self.convolutions = nn.ModuleList(
            nn.Conv2d(i, o, k, s, k // 2, bias=False) for i, o, k, s, _ in shape.convolutions)
        self.norms = nn.ModuleList(nn.BatchNorm2d(c[1]) for c in shape.convolutions)
        self.dense = nn.Linear(shape.features, shape.outputs)

    def forward(self, pictures):
        x = pictures * INPUT_STEP
        for convolution, norm, (*_, pooled) in zip(self.convolutions, self.norms, self.shape.convolutions):
            x = functional.relu6(norm(convolution(x)))
            if pooled:
                x = functional.max_pool2d(x, 2)
        return self.dense(x.flatten(1)).squeeze(1)  # removes the last dimension only if it is 1

    def folded(self):
        """Returns weights and biases of each layer, with the batch normalisation included. The last layer is the dense layer."""
        layers = []
        for convolution, norm in zip(self.convolutions, self.norms):
            gain = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            layers.append((convolution.weight * gain.view(-1, 1, 1, 1), norm.bias - norm.running_mean * gain))
        layers.append((self.dense.weight, self.dense.bias))
        return layers


class _Round(torch.autograd.Function):
    """Rounds half up. The gradient is not changed."""

    @staticmethod
    def forward(_, x):
        return torch.floor(x + 0.5)

    @staticmethod
    def backward(_, gradient):
        return gradient


class IntegerNavigator(nn.Module):
    """The network as the chip computes it, in a form that can be trained. Every value is a whole number in a float. Every sum is
    below 2^24, so it is exact. An output count is clip((sum of weight x input + bias + half) >> shift), with one shift per output
    channel. The scale of the weights is a power of two times the ratio of the steps, so no multiplier is needed.
    """

    def __init__(self, navigator):
        super().__init__()
        self.shape = navigator.shape
        self.weights = nn.ParameterList()
        self.biases = nn.ParameterList()
        for i, (weight, bias) in enumerate(navigator.folded()):
            step_in = INPUT_STEP if i == 0 else ACTIVATION_STEP
            step_out = OUTPUT_STEP if i == len(self.shape.convolutions) else ACTIVATION_STEP
            self.weights.append(nn.Parameter((weight * (step_in / step_out)).detach().clone()))
            self.biases.append(nn.Parameter((bias / step_out).detach().clone()))

    def layer(self, i):
        """Returns the integer weights and biases and the shifts of layer i."""
        weight, bias = self.weights[i], self.biases[i]
        largest = weight.detach().abs().flatten(1).amax(1).clamp(min=1e-6)
        shift = torch.floor(torch.log2(127.0 / largest)).clamp(1, 15)
        scale = 2.0 ** shift
        shape = (-1,) + (1,) * (weight.dim() - 1)
        return _Round.apply(weight * scale.view(shape)).clamp(-127, 127), _Round.apply(bias * scale), shift

    def forward(self, pictures):
        x = pictures
        for i, (_, _, kernel, stride, pooled) in enumerate(self.shape.convolutions):
            weight, bias, shift = self.layer(i)
            x = functional.conv2d(x, weight, bias, stride, kernel // 2)
            x = _Round.apply(x * (2.0 ** -shift).view(1, -1, 1, 1)).clamp(0, 255)
            if pooled:
                x = functional.max_pool2d(x, 2)
        weight, bias, shift = self.layer(len(self.shape.convolutions))
        # Activations on the chip have the order row, column, channel. Training uses the usual order channel, row, column.
        x = functional.linear(x.flatten(1), weight, bias)
        return _Round.apply(x * 2.0 ** -shift).squeeze(1)

    def take(self, layers):
        """Initialises the network from layers in the format of exported(), so that training can continue."""
        for i, (weights, biases, shifts) in enumerate(layers):
            scale = 2.0 ** -torch.tensor(shifts.astype("float32"))
            weight = torch.tensor(weights.astype("float32")).permute(0, 3, 1, 2)
            if i == len(layers) - 1:
                weight = weight.flatten(1)
            self.weights[i].data = (weight * scale.view((-1,) + (1,) * (weight.dim() - 1))).contiguous()
            self.biases[i].data = torch.tensor(biases.astype("float32")) * scale

    def exported(self):
        """Returns (weights, biases, shifts) of every layer as integer arrays in the chip's order: output channel, row, column,
        input channel."""
        layers = []
        last = len(self.shape.convolutions)
        for i in range(last + 1):
            weight, bias, shift = (t.detach() for t in self.layer(i))
            if i == last:
                weight = weight.view(self.shape.outputs, self.shape.convolutions[-1][1], 6, 6)
            layers.append((weight.permute(0, 2, 3, 1).to(torch.int8).numpy(), bias.to(torch.int32).numpy(),
                           shift.to(torch.uint8).numpy()))
        return layers
